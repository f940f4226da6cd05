// What a frame costs the client, on one core, by CPU time: drawing L, predicting the picture, unpacking, decoding,
// adding. And what the prediction takes of the server's frame.
//   client_cost SCENE [SPLIT] [WIDTH] [HEIGHT] [FRAMES] [QUANTIZER] [PASSES]   SCENE: a built-in name or a model file
// The client's stages run here one by one, on what a server sent, PASSES times from the start, and the smallest of each
// stage's times counts: others use the machine, too. Then a Client does it all. The pictures must be the server's, bit
// for bit.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/scene_shots.h"
#include "raster/sample_pattern.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/frame420.h"
#include "sim/model_prediction.h"
#include "sim/packet.h"
#include "sim/picture_packing.h"
#include "sim/server.h"
#include "sim/signed_composite.h"

namespace {

using namespace pac;
using bench::cpu_ms;
using bench::need;

enum Stage { kDraw, kHash, kToYcc, kPredict, kUnpack, kDecode, kKeep, kAdd, kStages, kReceive = kStages, kTimes };
constexpr const char* kStageNames[kStages] = {
    "draw L, depth and ids", "check the hash of L", "L to 4:2:0", "predict the picture", "unpack",
    "decode MPEG-1",         "keep the difference", "add to L"};

// The decoder of sim/assisted_video.cpp taken apart: model prediction of full differences.
class StagedClient {
 public:
  explicit StagedClient(const sim::SessionMessage& message)
      : message_(message),
        model_(need(sim::parse_model(message.model), "model")),
        renderer_(need(raster::Renderer::create(message.width, message.height, {.threads = 1}), "renderer")),
        packets_(sim::transforms_of(model_)),
        predictor_(message.width, message.height, sim::surfaces_of(model_), sample().x / 256.0, sample().y / 256.0,
                   best_isa(), sim::movers_of(model_)),
        packer_(message.width, message.height),
        decoder_(decoder_options(), best_isa()),
        low_(message.width, message.height),
        shown_(message.width, message.height),
        depth_(message.width, raster::kBandRows),
        id_(message.width, raster::kBandRows),
        base_(message.width, message.height) {}
  StagedClient(const StagedClient&) = delete;
  StagedClient& operator=(const StagedClient&) = delete;

  // ms of each stage.
  std::vector<double> receive(const Bytes& bytes) {
    std::vector<double> ms(kStages, 0);
    const auto packet = need(packets_.read(bytes), "packet");
    double last = cpu_ms();
    const auto done = [&](Stage stage) {
      const double now = cpu_ms();
      ms[stage] += now - last;
      last = now;
    };
    check(sim::move_objects(packet.objects, model_), "objects");
    const bool is_key = (packet.difference[0] & 1) != 0, is_packed = (packet.difference[0] & 16) != 0;
    if (is_key) predictor_.forget();
    predictor_.begin(packet.camera, packet.objects);
    sim::ImageHash hash(low_.width(), low_.height());
    const raster::RenderTargets targets{low_.view(), depth_.view(), id_.view()};
    const auto use_rows = [&](int first_row, int last_row) {
      done(kDraw);
      for (int y = first_row; y < last_row; ++y) hash.add_row(low_.row(y));
      done(kHash);
      sim::frame420_rows_from_rgb(low_.view(), first_row, last_row, base_);
      done(kToYcc);
      predictor_.add_rows(base_, depth_.view(), id_.view(), first_row, last_row);
      done(kPredict);
    };
    check(renderer_.render_bands(model_, packet.camera, message_.low, targets, use_rows), "L");
    done(kDraw);
    hash_ ^= hash.finish();
    reference_ = &predictor_.end();
    done(kPredict);
    std::span<const uint8_t> picture = packet.difference.subspan(1);
    if (is_packed) {
      unpacked_.clear();
      check(packer_.unpack(picture, is_key, predictor_.surface(), unpacked_), "unpack");
      picture = unpacked_;
    } else if (is_key) {
      packer_.forget();
    }
    done(kUnpack);
    decoder_.feed(picture);
    decoder_.end_picture();
    const mpeg1::DecodedPicture* decoded = need(decoder_.next(), "decode");
    done(kDecode);
    predictor_.keep(decoded->view.y, decoded->view.cb, decoded->view.cr, decoded->macroblocks);
    done(kKeep);
    sim::composite_signed(low_.view(), predictor_.difference(0), predictor_.difference(1), predictor_.difference(2),
                          shown_.view());
    done(kAdd);
    return ms;
  }

  const RgbImage& shown() const { return shown_; }

 private:
  template <class T>
  static void check(const Result<T>& result, const char* what) {
    if (result.ok()) return;
    std::fprintf(stderr, "client_cost: %s: %s\n", what, result.failure().text);
    std::exit(1);
  }
  raster::SampleOffset sample() const { return raster::sample_pattern(message_.low.samples)[0]; }
  mpeg1::DecoderOptions decoder_options() {
    mpeg1::DecoderOptions options;
    options.low_delay = true;
    options.reference = [](void* context, const mpeg1::PictureHeader&, const mpeg1::FrameView&) {
      return static_cast<const StagedClient*>(context)->reference_;
    };
    options.reference_context = this;
    return options;
  }

  sim::SessionMessage message_;
  raster::Scene model_;
  raster::Renderer renderer_;
  sim::PacketReader packets_;
  sim::ModelPredictor predictor_;
  sim::PicturePacker packer_;
  mpeg1::Decoder decoder_;
  RgbImage low_, shown_;
  DepthImage depth_;
  IdImage id_;
  Frame420 base_;
  const Frame420* reference_ = nullptr;
  Bytes unpacked_;
  uint64_t hash_ = 0;
};

// What a server sent, and the hashes of what it knows is shown.
struct Sent {
  std::vector<Bytes> packets;
  std::vector<uint64_t> shown;
  double server_ms = 0;  // a frame, without the first
};

bool receive_all(const Bytes& session, const Sent& sent, std::vector<std::vector<double>>& least) {
  StagedClient client(need(sim::read_session_message(session), "session"));
  for (size_t i = 0; i < sent.packets.size(); ++i) {
    const std::vector<double> ms = client.receive(sent.packets[i]);
    for (size_t stage = 0; stage < kStages; ++stage) least[i][stage] = std::fmin(least[i][stage], ms[stage]);
    if (sim::image_hash(client.shown().view()) == sent.shown[i]) continue;
    std::fprintf(stderr, "client_cost: frame %zu is not the server's\n", i);
    return false;
  }
  return true;
}

// The same by a Client into one picture.
bool receive_whole(const Bytes& session, const Sent& sent, std::vector<std::vector<double>>& least) {
  sim::Client client = need(sim::Client::create(session), "session");
  RgbImage shown;
  for (size_t i = 0; i < sent.packets.size(); ++i) {
    const double begin = cpu_ms();
    const auto received = client.receive(sent.packets[i], shown);
    least[i][kReceive] = std::fmin(least[i][kReceive], cpu_ms() - begin);
    if (received.ok() && sim::image_hash(shown.view()) == sent.shown[i]) continue;
    std::fprintf(stderr, "client_cost: the client's frame %zu is not the server's\n", i);
    return false;
  }
  return true;
}

void report(const std::vector<std::vector<double>>& frames, const Sent& sent) {
  std::printf("%-24s %9s %9s %9s\n", "ms of one core", "first", "others", "worst");
  double first_sum = 0, mean_sum = 0, worst_frame = 0, predict = 0;
  for (size_t stage = 0; stage < kStages; ++stage) {
    double sum = 0, worst = 0;
    for (size_t i = 1; i < frames.size(); ++i) {
      sum += frames[i][stage];
      worst = std::fmax(worst, frames[i][stage]);
    }
    const double mean = sum / static_cast<double>(frames.size() - 1);
    std::printf("%-24s %9.2f %9.2f %9.2f\n", kStageNames[stage], frames[0][stage], mean, worst);
    first_sum += frames[0][stage];
    mean_sum += mean;
    if (stage == kPredict || stage == kKeep) predict += mean;
  }
  for (size_t i = 1; i < frames.size(); ++i) {
    double sum = 0;
    for (size_t stage = 0; stage < kStages; ++stage) sum += frames[i][stage];
    worst_frame = std::fmax(worst_frame, sum);
  }
  std::printf("%-24s %9.2f %9.2f %9.2f\n", "all stages", first_sum, mean_sum, worst_frame);
  double received = 0, worst_received = 0;
  for (size_t i = 1; i < frames.size(); ++i) {
    received += frames[i][kReceive] / static_cast<double>(frames.size() - 1);
    worst_received = std::fmax(worst_received, frames[i][kReceive]);
  }
  std::printf("%-24s %9.2f %9.2f %9.2f\n", "Client::receive()", frames[0][kReceive], received, worst_received);
  std::printf("%.1f frames a second of one core on the mean of all but the first\n", 1e3 / received);
  size_t total = 0;
  for (size_t i = 1; i < sent.packets.size(); ++i) total += sent.packets[i].size();
  std::printf("first packet %zu bytes, others %zu on the mean\n", sent.packets[0].size(),
              total / (sent.packets.size() - 1));
  std::printf("server's frame %.2f ms (H, L, code, without the first); prediction %.2f ms: %.1f %% of it\n",
              sent.server_ms, predict, 100 * predict / sent.server_ms);
}

int number(int argc, char** argv, int place, int fallback) {
  return argc > place ? std::atoi(argv[place]) : fallback;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: client_cost SCENE [SPLIT] [WIDTH] [HEIGHT] [FRAMES] [QUANTIZER] [PASSES]\n");
    return 2;
  }
  bench::NamedScene scene = bench::load_scene(argv[1]);
  const std::string split_name = argc > 2 ? argv[2] : scene.set.default_split;
  const int width = number(argc, argv, 3, 1280), height = number(argc, argv, 4, 720);
  const int frames = number(argc, argv, 5, 24), passes = number(argc, argv, 7, 3);
  if (width < 1 || height < 1 || frames < 2 || passes < 1) {
    std::fprintf(stderr, "client_cost: sides and passes are above 0, frames above 1\n");
    return 2;
  }
  sim::ServerOptions options;
  options.width = width;
  options.height = height;
  options.codec = sim::Codec::mpeg1;
  options.video.quantizer_scale = number(argc, argv, 6, 10);
  options.threads = 1;
  const sim::Split split = need(sim::make_split(split_name, scene.set, {.quick_low = true}), "split");
  sim::Server server = need(sim::Server::create(scene.set, split, options), "server");
  const Bytes session = server.session();
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  Sent sent;
  for (int i = 0; i < frames; ++i) {
    const double begin = cpu_ms();
    sent.packets.push_back(need(server.frame(static_cast<uint32_t>(i), scene.camera(i, aspect)), "frame"));
    if (i > 0) sent.server_ms += (cpu_ms() - begin) / (frames - 1);
    sent.shown.push_back(sim::image_hash(server.last_frame().composite.view()));
  }
  std::vector<std::vector<double>> ms(static_cast<size_t>(frames), std::vector<double>(kTimes, HUGE_VAL));
  for (int pass = 0; pass < passes; ++pass)
    if (!receive_all(session, sent, ms) || !receive_whole(session, sent, ms)) return 1;
  std::printf("%s, split %s, %d x %d, %d frames, quantizer %.0f, %s; resident %zu bytes\n", argv[1], split.name.c_str(),
              width, height, frames, options.video.quantizer_scale, isa_name(best_isa()), session.size());
  report(ms, sent);
  std::printf("last picture's hash %016llx\n", static_cast<unsigned long long>(sent.shown.back()));
  return 0;
}
