// Bytes of the difference images of the built-in scenes at equal quality of the *composite* L + 2 (D - 127).
//   jpeg_differences DIR
// Writes each scene's D as DIR/SCENE.ppm; where mozjpeg_files.mjs has coded those, mozjpeg gets lines of its own.
// Percent of bytes (BD-rate, q15..q90) against Annex K's quantization tables with optimal Huffman tables, which are
// libjpeg-turbo's bytes; the metrics compare the composite with H.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/bd_rate.h"
#include "base/file_io.h"
#include "base/image_io.h"
#include "base/metrics.h"
#include "base/ssimulacra2.h"
#include "jpeg/jpeg.h"
#include "sim/difference.h"
#include "sim/experiment.h"

namespace {

using namespace pac;
using Bytes = std::vector<uint8_t>;

constexpr int kQualities[] = {15, 30, 45, 60, 75, 84, 90};
constexpr size_t kMetrics = 3;
constexpr const char* kMetricNames[kMetrics] = {"PSNR-RGB", "SSIM-Y", "SSIMULACRA2"};

struct Point {
  double bytes = 0;
  double quality[kMetrics] = {};
};
using Curve = std::vector<Point>;

struct Scene {
  std::string name;
  sim::Renderings pictures;
  Ssimulacra2 reference;
};

Point measure(const Scene& scene, const Bytes& file) {
  RgbImage shown = *jpeg::decode(file);
  sim::composite_image(scene.pictures.low.view(), shown.view(), shown.view());
  const ConstRgbView high = scene.pictures.high.view();
  Point point;
  point.bytes = static_cast<double>(file.size());
  point.quality[0] = psnr_rgb(high, shown.view());
  point.quality[1] = -10.0 * std::log10(1.0 - ssim_luma(high, shown.view()));
  point.quality[2] = scene.reference.score(shown.view());
  return point;
}

Curve code(const Scene& scene, jpeg::EncodeOptions options) {
  Curve curve;
  for (const int quality : kQualities) {
    options.quality = quality;
    curve.push_back(measure(scene, *jpeg::encode(scene.pictures.difference.view(), options)));
  }
  return curve;
}

double percent(const Curve& reference, const Curve& test, size_t m) {
  std::vector<RatePoint> a, b;
  for (const Point& point : reference) a.push_back({point.bytes, point.quality[m]});
  for (const Point& point : test) b.push_back({point.bytes, point.quality[m]});
  const auto rate = bd_rate(a, b);
  return rate.ok() ? rate->percent : std::nan("");
}

void report(const Scene& scene, const std::string& setting, const Curve& reference, const Curve& curve) {
  std::printf("%-16s %-27s", scene.name.c_str(), setting.c_str());
  for (size_t m = 0; m < kMetrics; ++m) std::printf("  %s %+6.1f", kMetricNames[m], percent(reference, curve, m));
  std::printf("   bytes at q75 %6.0f\n", curve[4].bytes);
  std::fflush(stdout);
}

void compare(const Scene& scene, const std::string& stem) {
  jpeg::EncodeOptions annex_k;
  const Curve reference = code(scene, annex_k);
  report(scene, "Annex K, optimal Huffman", reference, reference);
  annex_k.huffman = jpeg::Huffman::standard;
  report(scene, "Annex K, standard Huffman", reference, code(scene, annex_k));
  annex_k.huffman = jpeg::Huffman::difference;
  report(scene, "Annex K, difference Huffman", reference, code(scene, annex_k));
  for (const char* peer : {"moz-default", "moz-flat", "moz-ms-ssim"}) {
    Curve curve;
    for (const int quality : kQualities)
      if (const auto file = read_file(stem + "." + peer + "." + std::to_string(quality) + ".jpg"); file.ok())
        curve.push_back(measure(scene, *file));
    if (curve.size() == std::size(kQualities)) report(scene, peer, reference, curve);
  }
  using jpeg::Effort, jpeg::Tune;
  report(scene, "psnr default", reference, code(scene, jpeg::options_for(Effort::normal, Tune::psnr, 50)));
  report(scene, "psnr best", reference, code(scene, jpeg::options_for(Effort::best, Tune::psnr, 50)));
  for (const auto& [name, tune] : {std::pair{"ssim best", Tune::ssim}, std::pair{"visual best", Tune::visual}}) {
    jpeg::EncodeOptions options = jpeg::options_for(Effort::best, tune, 50);
    report(scene, name, reference, code(scene, options));
    options.seen = scene.pictures.high.view();
    report(scene, std::string(name) + ", H seen", reference, code(scene, options));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: jpeg_differences DIR\n");
    return 2;
  }
  for (const sim::BuiltinScene& builtin : sim::builtin_scenes()) {
    const sim::SceneSet set = builtin.build(1);
    const float aspect = static_cast<float>(set.width) / static_cast<float>(set.height);
    auto pictures = sim::render_split(set, builtin.camera(0, aspect), {});
    if (!pictures.ok()) {
      std::fprintf(stderr, "%s: %s\n", builtin.name, pictures.failure().text);
      return 1;
    }
    Ssimulacra2 reference(pictures->high.view());
    const Scene scene{builtin.name, std::move(*pictures), std::move(reference)};
    const std::string stem = std::string(argv[1]) + "/" + builtin.name;
    const auto ppm = encode_image(scene.pictures.difference.view(), "D.ppm");
    if (const auto written = write_file(stem + ".ppm", *ppm); !written.ok()) {
      std::fprintf(stderr, "%s.ppm: %s\n", stem.c_str(), written.failure().text);
      return 1;
    }
    compare(scene, stem);
  }
}
