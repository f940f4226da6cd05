// Polygon-assisted MPEG-1 against today's video codecs on the same frames H, by Debian's ffmpeg (libx264, libx265,
// libsvtav1).
//   video_peers SCENE [SPLIT] [FRAMES] [all]      SCENE: a built-in name or an OBJ file; `all` adds the peers' best:
//                                                 two passes, B pictures, SVT-AV1 preset 4 with random access
// Every arm at several rates, scored against H in RGB; then our bytes over each peer's at equal score, metric by
// metric. Charged: every frame from the first on, ours as whole packets with camera, hash and checksum. Not charged:
// containers' boxes (raw H.264 and H.265 streams, IVF less its headers), and the resident model.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "base/bd_rate.h"
#include "base/file_io.h"
#include "base/image_io.h"
#include "base/y4m.h"
#include "jpeg/jpeg.h"
#include "raster/load_ply.h"
#include "sim/frame420.h"
#include "sim/loaded_scene.h"
#include "sim/video_scores.h"
#include "sim/video_sequence.h"

namespace {

using namespace pac;

constexpr int kFramesPerSecond = 20;

struct Point {
  uint64_t bytes = 0;
  double score[3] = {};  // means of SSIMULACRA 2, FLIP, PSNR-HVS-M
  double worst[3] = {};  // of the worst 5 %
};

struct Arm {
  std::string name;
  std::vector<Point> points;
};

template <class T>
T need(Result<T> result, const char* what) {
  if (result.ok()) return std::move(*result);
  std::fprintf(stderr, "video_peers: %s: %s\n", what, result.failure().text);
  std::exit(1);
}

// ---- The sequence
// ----------------------------------------------------------------------------------------------------

sim::SceneSet load(const std::string& path) {
  raster::AssetSource assets;
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  assets.read = [folder](const std::string& name) { return read_file(folder + name); };
  assets.decode_image = [](std::span<const uint8_t> bytes) -> Result<RgbaImage> {
    if (bytes.size() < 2 || bytes[0] != 0xFF || bytes[1] != 0xD8) return decode_rgba(bytes);
    PAC_TRY(const RgbImage opaque, jpeg::decode(bytes));
    RgbaImage image(opaque.width(), opaque.height());
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        std::memcpy(image.pixel(x, y), opaque.pixel(x, y), 3);
        image.pixel(x, y)[3] = 255;
      }
    return image;
  };
  const Bytes bytes = need(read_file(path), path.c_str());
  return sim::scene_set_from(std::move(need(raster::load_model(bytes, assets), path.c_str()).scene));
}

struct Sequence {
  int width = 0, height = 0, samples = 1;
  raster::Scene low;
  std::vector<sim::Shot> shots;
};

Sequence draw(const std::string& name, const std::string& split_name, int frames) {
  const sim::BuiltinScene* builtin = sim::find_scene(name);
  const sim::SceneSet scene = builtin != nullptr ? builtin->build(1) : load(name);
  const sim::Split split = need(sim::make_split(split_name, scene), "split");
  Sequence out;
  out.width = scene.width;
  out.height = scene.height;
  out.samples = split.low.samples;
  sim::FrameRenderer renderer =
      need(sim::FrameRenderer::create(scene, split, false, out.width, out.height, 0, best_isa()), "renderer");
  out.low = renderer.low_scene();
  const float aspect = static_cast<float>(out.width) / static_cast<float>(out.height);
  for (int i = 0; i < frames; ++i) {
    const raster::Camera camera =
        builtin != nullptr ? builtin->camera(i, aspect) : sim::fit_camera(scene.fine, i, aspect);
    out.shots.push_back({camera, need(renderer.render(scene, camera, true), "render")});
  }
  return out;
}

// ---- Scores
// ----------------------------------------------------------------------------------------------------------

Point score(const Sequence& sequence, const std::vector<RgbImage>& shown, uint64_t bytes) {
  std::vector<sim::ScoredPair> pairs;
  for (size_t i = 0; i < shown.size(); ++i) pairs.push_back({sequence.shots[i].images.high.view(), shown[i].view()});
  const std::vector<sim::FrameScores> scores = sim::score_frames(pairs, 0);
  Point point;
  point.bytes = bytes;
  for (size_t kind = 0; kind < 3; ++kind) {
    const FrameSummary summary = sim::summarize(scores, kind);
    point.score[kind] = summary.mean;
    point.worst[kind] = summary.worst_5_percent;
  }
  return point;
}

void print(const std::string& name, const std::string& setting, const Point& p, size_t frames) {
  std::printf("%-30s %8s %9llu %8.1f   %7.2f %7.4f %6.2f   %7.2f %7.4f %6.2f\n", name.c_str(), setting.c_str(),
              static_cast<unsigned long long>(p.bytes),
              8e-3 * static_cast<double>(p.bytes) * kFramesPerSecond / static_cast<double>(frames), p.score[0],
              p.score[1], p.score[2], p.worst[0], p.worst[1], p.worst[2]);
  std::fflush(stdout);
}

// ---- Arms
// ------------------------------------------------------------------------------------------------------------

Arm our_arm(const Sequence& sequence, sim::Prediction prediction, sim::Difference difference, const char* name,
            const std::vector<double>& quantizers) {
  Arm arm{name, {}};
  for (const double quantizer : quantizers) {
    sim::AssistedVideoOptions options;
    options.prediction = prediction;
    options.difference = difference;
    options.quantizer_scale = quantizer;
    options.effort = mpeg1::Effort::best;
    const sim::AssistedScene scene{sequence.width, sequence.height, &sequence.low, sequence.samples};
    auto frames = need(sim::code_assisted_video(sequence.shots, scene, options, best_isa(), true), name);
    std::vector<RgbImage> shown;
    for (sim::VideoFrame& frame : frames) shown.push_back(std::move(frame.shown));
    arm.points.push_back(score(sequence, shown, sim::total_bytes(frames)));
    print(name, std::to_string(quantizer).substr(0, 4), arm.points.back(), shown.size());
  }
  return arm;
}

Arm plain_arm(const Sequence& sequence, const std::vector<double>& quantizers) {
  Arm arm{"MPEG-1 of H", {}};
  for (const double quantizer : quantizers) {
    sim::ImageVideoOptions options;
    options.quantizer_scale = quantizer;
    options.effort = mpeg1::Effort::best;
    auto frames = need(sim::code_image_video(sequence.shots, options, true), "MPEG-1");
    std::vector<RgbImage> shown;
    for (sim::VideoFrame& frame : frames) shown.push_back(std::move(frame.shown));
    arm.points.push_back(score(sequence, shown, sim::total_bytes(frames)));
    print(arm.name, std::to_string(quantizer).substr(0, 4), arm.points.back(), shown.size());
  }
  return arm;
}

struct Peer {
  const char* name;
  const char* options;  // of ffmpeg; %d: the quality
  const char* format;
  std::vector<int> qualities;
  bool two_pass = false;  // qualities are kb/s
  bool extra = false;     // only with `all`
};

const std::vector<Peer>& peers() {
  static const std::vector<Peer> list = {
      {"x264 veryslow zerolatency",
       "-c:v libx264 -preset veryslow -tune zerolatency -g 600 -crf %d",
       "h264",
       {24, 28, 32, 36, 40}},
      {"SVT-AV1 p4 low delay",
       "-c:v libsvtav1 -preset 4 -g 600 -crf %d -svtav1-params pred-struct=1",
       "ivf",
       {30, 38, 46, 54, 60}},
      {"x264 veryslow, two-pass, B",
       "-c:v libx264 -preset veryslow -g 600 -b:v %dk",
       "h264",
       {60, 120, 240, 480},
       true,
       true},
      {"x265 veryslow zerolatency",
       "-c:v libx265 -preset slower -tune zerolatency -x265-params log-level=0:keyint=600 -crf %d",
       "hevc",
       {24, 28, 32, 36, 40},
       false,
       true},
      {"SVT-AV1 p4 random access", "-c:v libsvtav1 -preset 4 -g 600 -crf %d", "ivf", {30, 38, 46, 54, 60}, false, true},
  };
  return list;
}

bool run(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// IVF: 32 bytes of file header, 12 before each frame.
uint64_t code_bytes(const Bytes& file, const std::string& format, size_t frames) {
  return format == "ivf" ? file.size() - 32 - 12 * frames : file.size();
}

Arm peer_arm(const Sequence& sequence, const Peer& peer, const std::string& folder) {
  Arm arm{peer.name, {}};
  const std::string quiet = "ffmpeg -v error -y ", code = folder + "/code." + peer.format;
  for (const int quality : peer.qualities) {
    char options[256];
    std::snprintf(options, sizeof options, peer.options, quality);
    const std::string encode = "cd " + folder + " && SVT_LOG=0 " + quiet + "-i h.y4m " + options + " -pix_fmt yuv420p ";
    bool done = !peer.two_pass || run(encode + "-pass 1 -f null /dev/null 2>/dev/null");
    done = done && run(encode + (peer.two_pass ? "-pass 2 " : "") + "-f " + peer.format + " " + code + " 2>/dev/null");
    done = done && run(quiet + "-i " + code + " -f rawvideo -pix_fmt yuv420p " + folder + "/shown.yuv 2>/dev/null");
    if (!done) {
      std::printf("%-30s not there\n", peer.name);
      return {peer.name, {}};
    }
    const Bytes raw = need(read_file(folder + "/shown.yuv"), "decoded frames");
    const uint8_t* at = raw.data();
    std::vector<RgbImage> shown;
    Frame420 frame(sequence.width, sequence.height);
    for (size_t i = 0; i < sequence.shots.size(); ++i) {
      for (GrayImage* plane : {&frame.y, &frame.cb, &frame.cr})
        for (int y = 0; y < plane->height(); ++y, at += plane->width())
          std::memcpy(plane->row(y), at, static_cast<size_t>(plane->width()));
      RgbImage picture(sequence.width, sequence.height);
      sim::rgb_from_frame420(frame, picture.view());
      shown.push_back(std::move(picture));
    }
    const Bytes file = need(read_file(code), "code");
    arm.points.push_back(score(sequence, shown, code_bytes(file, peer.format, shown.size())));
    print(peer.name, std::to_string(quality) + (peer.two_pass ? "k" : ""), arm.points.back(), shown.size());
  }
  return arm;
}

// Our bytes over the peer's at equal score, over the scores that both reach.
void compare(const Arm& ours, const Arm& peer) {
  if (peer.points.empty()) return;
  const char* metrics[] = {"SSIMULACRA 2", "FLIP", "PSNR-HVS-M"};
  std::printf("%s / %s:", ours.name.c_str(), peer.name.c_str());
  for (int worst = 0; worst < 2; ++worst)
    for (size_t kind = 0; kind < 3; ++kind) {
      std::vector<RatePoint> curves[2];
      for (int side = 0; side < 2; ++side)
        for (const Point& p : (side == 0 ? peer : ours).points)
          curves[side].push_back({static_cast<double>(p.bytes), worst != 0 ? p.worst[kind] : p.score[kind]});
      const auto rate = bd_rate(curves[0], curves[1]);
      std::printf("%s %s ", kind == 0 ? (worst != 0 ? "; worst 5 %:" : " mean:") : ",", metrics[kind]);
      if (rate.ok())
        std::printf("%.3f (%.3g..%.3g)", 1 + rate->percent / 100, rate->lowest_quality, rate->highest_quality);
      else
        std::printf("no common range");
    }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: video_peers SCENE [SPLIT] [FRAMES] [all]\n");
    return 2;
  }
  const std::string scene = argv[1], split = argc > 2 ? argv[2] : "texture";
  const int frames = argc > 3 ? std::atoi(argv[3]) : 48;
  const bool all = argc > 4 && std::strcmp(argv[4], "all") == 0;
  const Sequence sequence = draw(scene, split, frames);

  char folder[] = "/tmp/video_peers_XXXXXX";
  if (mkdtemp(folder) == nullptr) return 1;
  Bytes y4m;
  append_y4m_header(y4m, {sequence.width, sequence.height, kFramesPerSecond, 1, 1, 1, ChromaSiting::jpeg});
  Frame420 frame(sequence.width, sequence.height);
  for (const sim::Shot& shot : sequence.shots) {
    sim::frame420_from_rgb(shot.images.high.view(), frame);
    append_y4m_frame(y4m, frame);
  }
  if (!write_file(std::string(folder) + "/h.y4m", y4m).ok()) return 1;

  std::printf("%s, split %s, %d x %d, %zu frames at %d a second\n%-30s %8s %9s %8s   %7s %7s %6s   %s\n", scene.c_str(),
              split.c_str(), sequence.width, sequence.height, sequence.shots.size(), kFramesPerSecond, "", "setting",
              "bytes", "kb/s", "SSIMU2", "FLIP", "HVS-M", "worst 5 % of each");
  const std::vector<double> quantizers = {6, 10, 16, 24, 31};
  const Arm ours =
      our_arm(sequence, sim::Prediction::model, sim::Difference::full, "polygons + MPEG-1, model", quantizers);
  std::vector<Arm> others;
  others.push_back(
      our_arm(sequence, sim::Prediction::block, sim::Difference::halved, "polygons + MPEG-1, block", quantizers));
  others.push_back(plain_arm(sequence, {6, 10, 16, 31}));
  for (const Peer& peer : peers())
    if (all || !peer.extra) others.push_back(peer_arm(sequence, peer, folder));
  std::printf("\nbytes of the first over the second's at equal score\n");
  for (const Arm& other : others) compare(ours, other);
  return run(std::string("rm -r ") + folder) ? 0 : 1;
}
