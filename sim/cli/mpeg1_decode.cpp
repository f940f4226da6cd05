// `pac mpeg1 decode` and `pac mpeg1 info`.
#include <cstdio>

#include "base/y4m.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/system.h"
#include "sim/cli/command.h"

namespace pac::cli {
namespace {

// The elementary stream in a file of either kind.
Result<std::vector<uint8_t>> video_of(std::vector<uint8_t> bytes, bool& was_system, uint64_t& system_errors) {
  was_system = mpeg1::is_system_stream(bytes);
  if (!was_system) return bytes;
  auto system = mpeg1::demultiplex(bytes);
  if (!system.ok()) return system.failure();
  system_errors = system->errors;
  return std::move(system->video);
}

// pel_aspect_ratio codes as height over width of a sample [11172-2 2.4.3.2], in 1/10000.
constexpr int kPelAspects[15] = {0,    10000, 6735,  7031,  7615,  8055,  8437, 8935,
                                 9157, 9815,  10255, 10695, 10950, 11575, 12015};

Y4mHeader y4m_header(const mpeg1::SequenceHeader& sequence) {
  Y4mHeader header;
  header.width = sequence.width;
  header.height = sequence.height;
  const int milli = mpeg1::kPictureRatesMilli[sequence.picture_rate_code];
  const bool is_ntsc = milli % 1000 != 0;  // 24, 30 and 60 times 1000/1001
  header.rate_numerator = is_ntsc ? (milli / 1000 + 1) * 1000 : milli / 1000;
  header.rate_denominator = is_ntsc ? 1001 : 1;
  header.aspect_numerator = sequence.pel_aspect_ratio_code == 1 ? 1 : 10000;
  header.aspect_denominator = sequence.pel_aspect_ratio_code == 1 ? 1 : kPelAspects[sequence.pel_aspect_ratio_code];
  return header;
}

struct Decoded {
  std::vector<uint8_t> y4m;
  uint64_t frames = 0;
  Y4mHeader header;
  std::string other_size;  // why the stream was cut short
};

// Appends pictures until the stream ends or fails.
Result<void> decode_pictures(mpeg1::Decoder& decoder, Decoded& out) {
  for (;;) {
    PAC_TRY(const mpeg1::DecodedPicture* picture, decoder.next());
    if (picture == nullptr) return {};
    if (out.frames == 0) {
      out.header = y4m_header(*decoder.sequence());
      append_y4m_header(out.y4m, out.header);
    } else if (picture->view.width() != out.header.width || picture->view.height() != out.header.height) {
      return Failure{Error::unsupported, picture->byte_offset, "the picture size changes: Y4M has one size"};
    }
    append_y4m_frame(out.y4m, mpeg1::copy_of(picture->view));
    ++out.frames;
  }
}

int print_summary(const Options& options, const Decoded& decoded, const mpeg1::ErrorReport& report) {
  if (!options.json) return kDone;
  sim::JsonWriter json;
  json.begin_object();
  json.field("width", decoded.header.width);
  json.field("height", decoded.header.height);
  json.field("frames", decoded.frames);
  json.field("errors", report.errors);
  json.field("concealed_macroblocks", report.concealed_macroblocks);
  json.field("dropped_pictures", report.dropped_pictures);
  json.end_object();
  return print_json(json);
}

}  // namespace

int run_mpeg1_decode(Args args) {
  Options options("mpeg1 decode", "writes MPEG-1 video as Y4M", "pac mpeg1 decode clip.m1v -o clip-decoded.y4m");
  std::string in, out;
  bool lenient = false;
  options.positional("IN", in, "an elementary or a system stream; - is stdin");
  options.text("-o|--output", "OUT.y4m", out, "- is stdout", true);
  options.flag("--lenient", lenient, "conceal what is damaged; the exit code is 1 still");
  if (const auto code = options.parse(args)) return *code;
  if (options.json && out == "-") return options.usage_error("--json and -o - both want stdout");
  auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  bool was_system = false;
  uint64_t system_errors = 0;
  const auto video = video_of(std::move(*bytes), was_system, system_errors);
  if (!video.ok()) return data_error(in, video.failure());
  mpeg1::DecoderOptions decoder_options;
  decoder_options.strict = !lenient;
  mpeg1::Decoder decoder(decoder_options, options.isa);
  decoder.feed(*video);
  decoder.finish();
  Decoded decoded;
  const auto done = decode_pictures(decoder, decoded);
  if (!done.ok() && !lenient) return data_error(in, done.failure());
  if (decoded.frames == 0)
    return done.ok() ? data_error(in, "no picture in the stream") : data_error(in, done.failure());
  if (const int code = write_output(out, decoded.y4m); code != kDone) return code;
  if (!done.ok()) return data_error(in, done.failure());
  if (decoder.report().errors > 0) return data_error(in, decoder.report().first);
  return print_summary(options, decoded, decoder.report());
}

int run_mpeg1_info(Args args) {
  Options options("mpeg1 info", "what the headers of MPEG-1 video say", "pac mpeg1 info clip.m1v");
  std::string in;
  options.positional("IN", in, "an elementary or a system stream; - is stdin");
  if (const auto code = options.parse(args)) return *code;
  auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  bool was_system = false;
  uint64_t system_errors = 0;
  const auto video = video_of(std::move(*bytes), was_system, system_errors);
  if (!video.ok()) return data_error(in, video.failure());
  const auto info = mpeg1::read_info(*video);
  if (!info.ok()) return data_error(in, info.failure());
  const mpeg1::SequenceHeader& s = info->sequence;
  const double rate = mpeg1::kPictureRatesMilli[s.picture_rate_code] / 1000.0;
  const bool is_variable = s.bit_rate == 0x3FFFF;
  if (options.json) {
    sim::JsonWriter json;
    json.begin_object();
    json.field("system_stream", was_system);
    json.field("width", s.width);
    json.field("height", s.height);
    json.fixed_field("picture_rate", rate, 3);
    json.field("bit_rate_bps", is_variable ? 0 : s.bit_rate * 400);
    json.field("vbv_buffer_bits", s.vbv_buffer_size * 16384);
    json.field("constrained_parameters", s.constrained_parameters);
    json.field("intra_matrix", s.has_intra_matrix);
    json.field("non_intra_matrix", s.has_non_intra_matrix);
    json.field("i_pictures", info->pictures[1]);
    json.field("p_pictures", info->pictures[2]);
    json.field("b_pictures", info->pictures[3]);
    json.field("d_pictures", info->pictures[4]);
    json.field("repeated_pictures", info->repeated_pictures);
    json.field("groups", info->groups);
    json.field("slices", info->slices);
    json.field("bytes", uint64_t{video->size()});
    json.end_object();
    return print_json(json);
  }
  std::printf("MPEG-1 video%s, %dx%d, %.3f pictures a second\n", was_system ? " in a system stream" : "", s.width,
              s.height, rate);
  if (is_variable)
    std::printf("bit rate       variable\n");
  else
    std::printf("bit rate       %s bits a second\n", grouped(static_cast<uint64_t>(s.bit_rate) * 400).c_str());
  std::printf("VBV buffer     %s bits\n", grouped(static_cast<uint64_t>(s.vbv_buffer_size) * 16384).c_str());
  std::printf("constrained    %s\n", s.constrained_parameters ? "yes" : "no");
  std::printf("matrices       intra %s, non-intra %s\n", s.has_intra_matrix ? "own" : "default",
              s.has_non_intra_matrix ? "own" : "default");
  std::printf("pictures       %llu I, %llu P, %llu B, %llu D in %llu groups\n",
              static_cast<unsigned long long>(info->pictures[1]), static_cast<unsigned long long>(info->pictures[2]),
              static_cast<unsigned long long>(info->pictures[3]), static_cast<unsigned long long>(info->pictures[4]),
              static_cast<unsigned long long>(info->groups));
  if (info->repeated_pictures > 0)
    std::printf("repeated       %llu P pictures show the one before again (the source is slower than %.3f)\n",
                static_cast<unsigned long long>(info->repeated_pictures), rate);
  std::printf("bytes          %s\n", grouped(video->size()).c_str());
  return kDone;
}

}  // namespace pac::cli
