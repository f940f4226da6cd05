// Our MPEG-1 encoder and decoder beside libavcodec and libmpeg2, in one run, one thread, CPU time, in memory.
//   build/release/bench/peers/mpeg1_peers clip.y4m...
// Prints, for each clip, bytes, PSNR and speed at four quantizers, BD-rates (PSNR of luma against bytes) relative to
// libavcodec's default, and decoding speed of each stream by each decoder with ratios; at the end a table for each size
// of pictures. mpeg1_clips.sh makes clips of 640x480 and 1280x720.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
#include <mpeg2dec/mpeg2.h>
}
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "base/file_io.h"
#include "base/metrics.h"
#include "bench/peers/bd_rate.h"
#include "bench/peers/encode_clip.h"
#include "mpeg1/mpeg1.h"

namespace {

using namespace pac;
using namespace pac::bench;

constexpr int kQuantizers[] = {2, 4, 8, 16};
constexpr int kGroup = 15;

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Coded {
  std::vector<uint8_t> bytes;
  double seconds = 0;
  double psnr_db = 0, ssim = 0;
};

// Quality of what our decoder shows (others differ by less than their transforms do).
void judge(const Clip& clip, Coded& coded) {
  mpeg1::Decoder decoder;
  decoder.feed(coded.bytes);
  decoder.finish();
  double error = 0, similarity = 0;
  size_t n = 0;
  for (;;) {
    const auto picture = decoder.next();
    if (!picture.ok() || *picture == nullptr || n == clip.size()) break;
    error += mean_squared_error((*picture)->view.y, clip[n].y.view());
    if (n % 5 == 0) similarity += 5 * ssim((*picture)->view.y, clip[n].y.view());
    ++n;
  }
  if (n != clip.size()) std::printf("  (%zu of %zu pictures decoded)\n", n, clip.size());
  coded.psnr_db = psnr_from_mse(error / static_cast<double>(std::max<size_t>(n, 1)));
  coded.ssim = similarity / static_cast<double>((clip.size() + 4) / 5 * 5);
}

Coded encode_ours(const Clip& clip, int quantizer, mpeg1::Effort effort, bool looks_ahead) {
  mpeg1::SequenceOptions options;
  options.gop_length = kGroup;
  options.quantizer_scale = quantizer;
  options.effort = effort;
  Coded coded;
  coded.seconds = bench::encode_clip(clip, options, looks_ahead, cpu_seconds, coded.bytes);
  return coded;
}

struct AvSetting {
  const char* name;
  const char* options;  // "key=value:key=value" of the codec
};
constexpr AvSetting kAvDefault{"libavcodec", ""};
constexpr AvSetting kAvTrellis{"libavcodec rd+trellis", "mbd=rd:trellis=1"};
constexpr AvSetting kAvBest{"libavcodec best",
                            "mbd=rd:trellis=2:cmp=rd:subcmp=rd:mbcmp=rd:mpv_flags=+qp_rd:me_range=64:dia_size=4"};

AVCodecContext* open_av(const Clip& clip, int quantizer, const AvSetting& setting) {
  const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_MPEG1VIDEO);
  AVCodecContext* context = avcodec_alloc_context3(codec);
  context->width = clip[0].width();
  context->height = clip[0].height();
  context->pix_fmt = AV_PIX_FMT_YUV420P;
  context->time_base = {1, 30};
  context->framerate = {30, 1};
  context->gop_size = kGroup;
  context->max_b_frames = 0;
  context->thread_count = 1;
  context->flags |= AV_CODEC_FLAG_QSCALE;
  context->global_quality = quantizer * FF_QP2LAMBDA;
  av_opt_set(context, "sc_threshold", "1000000000", AV_OPT_SEARCH_CHILDREN);
  AVDictionary* dictionary = nullptr;
  av_dict_parse_string(&dictionary, setting.options, "=", ":", 0);
  if (avcodec_open2(context, codec, &dictionary) < 0) avcodec_free_context(&context);
  av_dict_free(&dictionary);
  return context;
}

void copy_frame(const Frame420& from, AVFrame* to) {
  const GrayImage* planes[3] = {&from.y, &from.cb, &from.cr};
  for (int p = 0; p < 3; ++p)
    for (int y = 0; y < planes[p]->height(); ++y)
      std::memcpy(to->data[p] + y * to->linesize[p], planes[p]->row(y), static_cast<size_t>(planes[p]->width()));
}

Coded encode_av(const Clip& clip, int quantizer, const AvSetting& setting) {
  Coded coded;
  AVCodecContext* context = open_av(clip, quantizer, setting);
  if (context == nullptr) return coded;
  AVFrame* frame = av_frame_alloc();
  AVPacket* packet = av_packet_alloc();
  frame->format = AV_PIX_FMT_YUV420P;
  frame->width = context->width;
  frame->height = context->height;
  av_frame_get_buffer(frame, 64);
  const auto send = [&](const AVFrame* what) {
    const double start = cpu_seconds();
    avcodec_send_frame(context, what);
    while (avcodec_receive_packet(context, packet) == 0) {
      coded.bytes.insert(coded.bytes.end(), packet->data, packet->data + packet->size);
      av_packet_unref(packet);
    }
    coded.seconds += cpu_seconds() - start;
  };
  for (size_t i = 0; i < clip.size(); ++i) {
    av_frame_make_writable(frame);
    copy_frame(clip[i], frame);
    frame->pts = static_cast<int64_t>(i);
    frame->quality = context->global_quality;
    send(frame);
  }
  send(nullptr);
  av_packet_free(&packet);
  av_frame_free(&frame);
  avcodec_free_context(&context);
  return coded;
}

// ---- Decoders: seconds for the whole stream, and the number of pictures --------------------------------------------

struct Timing {
  double seconds = 0;
  int pictures = 0;
};

Timing decode_ours(const std::vector<uint8_t>& bytes) {
  Timing timing;
  mpeg1::Decoder decoder;
  const double start = cpu_seconds();
  decoder.feed(bytes);
  decoder.finish();
  for (;;) {
    const auto picture = decoder.next();
    if (!picture.ok() || *picture == nullptr) break;
    ++timing.pictures;
  }
  timing.seconds = cpu_seconds() - start;
  return timing;
}

Timing decode_av(const std::vector<uint8_t>& bytes) {
  Timing timing;
  AVCodecContext* context = avcodec_alloc_context3(avcodec_find_decoder(AV_CODEC_ID_MPEG1VIDEO));
  context->thread_count = 1;
  if (avcodec_open2(context, nullptr, nullptr) < 0) return timing;
  AVCodecParserContext* parser = av_parser_init(AV_CODEC_ID_MPEG1VIDEO);
  AVFrame* frame = av_frame_alloc();
  AVPacket* packet = av_packet_alloc();
  std::vector<uint8_t> padded(bytes);
  padded.resize(bytes.size() + AV_INPUT_BUFFER_PADDING_SIZE);
  const uint8_t* at = padded.data();
  auto left = static_cast<int>(bytes.size());
  const double start = cpu_seconds();
  const auto send = [&](const AVPacket* what) {
    avcodec_send_packet(context, what);
    while (avcodec_receive_frame(context, frame) == 0) ++timing.pictures;
  };
  for (bool more = true; more;) {
    uint8_t* unit = nullptr;
    int size = 0;
    more = left > 0;
    const int used = av_parser_parse2(parser, context, &unit, &size, at, left, AV_NOPTS_VALUE, AV_NOPTS_VALUE, 0);
    at += used;
    left -= used;
    if (size == 0) continue;
    packet->data = unit;
    packet->size = size;
    send(packet);
  }
  send(nullptr);
  timing.seconds = cpu_seconds() - start;
  av_parser_close(parser);
  packet->data = nullptr;
  av_packet_free(&packet);
  av_frame_free(&frame);
  avcodec_free_context(&context);
  return timing;
}

Timing decode_libmpeg2(std::vector<uint8_t> bytes) {
  Timing timing;
  const double start = cpu_seconds();
  mpeg2dec_t* decoder = mpeg2_init();
  const mpeg2_info_t* info = mpeg2_info(decoder);
  bool fed = false;
  for (bool done = false; !done;) {
    const mpeg2_state_t state = mpeg2_parse(decoder);
    if (state == STATE_BUFFER) {
      done = fed;
      if (!fed) mpeg2_buffer(decoder, bytes.data(), bytes.data() + bytes.size());
      fed = true;
    } else if (state == STATE_SLICE || state == STATE_END || state == STATE_INVALID_END) {
      if (info->display_fbuf != nullptr) ++timing.pictures;
    }
  }
  mpeg2_close(decoder);
  timing.seconds = cpu_seconds() - start;
  return timing;
}

Curve curve_of(std::vector<Coded>& points) {
  std::sort(points.begin(), points.end(), [](const Coded& a, const Coded& b) { return a.psnr_db < b.psnr_db; });
  Curve curve;
  for (const Coded& point : points) {
    curve.psnr_db.push_back(point.psnr_db);
    curve.log_rate.push_back(std::log(static_cast<double>(point.bytes.size())));
  }
  return curve;
}

// ---- Tables --------------------------------------------------------------------------------------------------------

struct Contender {
  std::string name;
  std::vector<Coded> points;
};

// The fastest of up to seven rounds: of those that begin within the first half of a second.
template <class Encode>
Coded fastest(const Encode& encode) {
  constexpr int kMostRounds = 7;
  constexpr double kEnoughSeconds = 0.5;
  Coded coded = encode();
  double spent = coded.seconds;
  for (int round = 1; round < kMostRounds && spent < kEnoughSeconds; ++round) {
    const double seconds = encode().seconds;
    coded.seconds = std::min(coded.seconds, seconds);
    spent += seconds;
  }
  return coded;
}

template <class Encode>
Contender contend(const Clip& clip, const char* name, const Encode& encode) {
  Contender contender{name, {}};
  for (const int quantizer : kQuantizers) {
    contender.points.push_back(fastest([&] { return encode(quantizer); }));
    Coded& coded = contender.points.back();
    judge(clip, coded);
    const auto n = static_cast<double>(clip.size());
    std::printf("  %-22s q%-3d %9zu bytes %7.3f dB  SSIM %.4f %8.1f fps\n", name, quantizer, coded.bytes.size(),
                coded.psnr_db, coded.ssim, n / coded.seconds);
    std::fflush(stdout);
  }
  return contender;
}

double total_seconds(const Contender& contender) {
  double sum = 0;
  for (const Coded& point : contender.points) sum += point.seconds;
  return sum;
}

std::vector<double> compare_decoders(const Clip& clip, const Contender& contender) {
  std::vector<double> ratios;
  for (const Coded& point : contender.points) {
    const std::vector<uint8_t>& bytes = point.bytes;
    double best[3] = {1e9, 1e9, 1e9};
    int pictures[3] = {};
    for (int round = 0; round < 7; ++round) {
      const Timing timings[3] = {decode_ours(bytes), decode_av(bytes), decode_libmpeg2(bytes)};
      for (int d = 0; d < 3; ++d) {
        best[d] = std::min(best[d], timings[d].seconds);
        pictures[d] = timings[d].pictures;
      }
    }
    const auto n = static_cast<double>(clip.size());
    std::printf("  decode %6.2f Mb/s  ours %6.0f fps  libavcodec %6.0f  libmpeg2 %6.0f  ratio to the faster %.2f%s\n",
                static_cast<double>(bytes.size()) * 8 * 30 / n / 1e6, n / best[0], n / best[1], n / best[2],
                std::min(best[1], best[2]) / best[0],
                pictures[0] == static_cast<int>(clip.size()) ? "" : "  (pictures differ)");
    ratios.push_back(std::min(best[1], best[2]) / best[0]);
  }
  return ratios;
}

// What the table at the end says of a clip: by contender after libavcodec's default.
struct Row {
  std::string clip;
  int width = 0, height = 0;
  std::vector<std::string> names;
  std::vector<double> bd_percent, speed;
  std::vector<double> decoding;  // our speed to the faster peer's, by quantizer
};

Row compare(const std::string& path, bool with_slow_peers) {
  Row row;
  const Clip clip = read_clip(path);
  if (clip.empty()) {
    std::printf("%s: no clip\n", path.c_str());
    return row;
  }
  const size_t slash = path.rfind('/');
  row.clip = slash == std::string::npos ? path : path.substr(slash + 1);
  row.width = clip[0].width();
  row.height = clip[0].height();
  std::printf("%s: %zu frames of %dx%d\n", path.c_str(), clip.size(), clip[0].width(), clip[0].height());
  std::vector<Contender> all;
  const auto av = [&](const AvSetting& setting) {
    return contend(clip, setting.name, [&](int q) { return encode_av(clip, q, setting); });
  };
  const auto ours = [&](const char* name, mpeg1::Effort effort, bool looks_ahead) {
    return contend(clip, name, [&](int q) { return encode_ours(clip, q, effort, looks_ahead); });
  };
  all.push_back(av(kAvDefault));
  if (with_slow_peers) {
    all.push_back(av(kAvTrellis));
    all.push_back(av(kAvBest));
  }
  all.push_back(ours("pac fast", mpeg1::Effort::fast, false));
  all.push_back(ours("pac default", mpeg1::Effort::normal, false));
  all.push_back(ours("pac best", mpeg1::Effort::best, false));
  all.push_back(ours("pac default, ahead", mpeg1::Effort::normal, true));
  all.push_back(ours("pac best, ahead", mpeg1::Effort::best, true));
  row.decoding = compare_decoders(clip, all[0]);
  const double base_seconds = total_seconds(all[0]);
  const Curve base = curve_of(all[0].points);
  for (size_t i = 1; i < all.size(); ++i) {
    row.names.push_back(all[i].name);
    row.bd_percent.push_back(bd_rate(base, curve_of(all[i].points)));
    row.speed.push_back(base_seconds / total_seconds(all[i]));
    std::printf("  %-22s BD-rate %+6.2f %%  speed x%.2f of libavcodec's default\n", all[i].name.c_str(),
                row.bd_percent.back(), row.speed.back());
  }
  return row;
}

// Markdown: one line a clip, sizes apart.
void print_table(const std::vector<Row>& rows, int width, int height) {
  bool has_head = false;
  for (const Row& row : rows) {
    if (row.width != width || row.height != height) continue;
    if (!has_head) {
      std::printf("\n| %dx%d |", width, height);
      for (const std::string& name : row.names) std::printf(" %s |", name.c_str());
      std::printf(" decoding |\n| --- |");
      for (size_t i = 0; i <= row.names.size(); ++i) std::printf(" --- |");
      has_head = true;
    }
    std::printf("\n| %s |", row.clip.c_str());
    for (size_t i = 0; i < row.names.size(); ++i) std::printf(" %+.1f %% x%.2f |", row.bd_percent[i], row.speed[i]);
    for (const double ratio : row.decoding) std::printf(" %.2f", ratio);
    std::printf(" |");
  }
  std::printf("\n");
}

void print_tables(const std::vector<Row>& rows) {
  for (size_t i = 0; i < rows.size(); ++i) {
    const auto same = [&](const Row& row) { return row.width == rows[i].width && row.height == rows[i].height; };
    if (std::find_if(rows.begin(), rows.end(), same) - rows.begin() == static_cast<ptrdiff_t>(i))
      print_table(rows, rows[i].width, rows[i].height);
  }
}

}  // namespace

int main(int argc, char** argv) {
  av_log_set_level(AV_LOG_ERROR);
  bool with_slow_peers = true;
  std::vector<Row> rows;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0)
      with_slow_peers = false;
    else
      rows.push_back(compare(argv[i], with_slow_peers));
    if (!rows.empty() && rows.back().names.empty()) rows.pop_back();
  }
  print_tables(rows);
  if (argc < 2)
    std::printf("usage: mpeg1_peers [--quick] CLIP.y4m...   (--quick: without libavcodec's slow settings)\n");
  return 0;
}
