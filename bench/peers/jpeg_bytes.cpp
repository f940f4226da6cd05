// Bytes at equal quality: our encoder against libjpeg-turbo with optimal Huffman tables, as BD-rate (base/bd_rate.h).
//   jpeg_bytes PICTURE.ppm|.png ...
// Percent of bytes for each picture, metric and setting of ours, at qualities 15 to 90, 4:2:0; then the mean and the
// worst picture. Both files are decoded by our decoder, whose pixels are djpeg's. Files NAME.SETTING.QUALITY.jpg beside
// a picture NAME.ppm, which mozjpeg_files.mjs writes, are a peer's and get a line of their own.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "base/bd_rate.h"
#include "base/file_io.h"
#include "base/image_io.h"
#include "base/metrics.h"
#include "base/psnr_hvs.h"
#include "base/ssimulacra2.h"
#include "bench/peers/libjpeg_turbo.h"
#include "jpeg/jpeg.h"

namespace {

using namespace pac;
using Bytes = std::vector<uint8_t>;

constexpr int kQualities[] = {15, 30, 45, 60, 75, 84, 90};
// The last two are those that two of mozjpeg's tables are made for.
constexpr const char* kMetricNames[] = {"PSNR-RGB", "PSNR-Y", "SSIM-Y", "SSIMULACRA2", "PSNR-HVS-M", "MS-SSIM"};
constexpr size_t kMetrics = std::size(kMetricNames);

struct Point {
  double bytes = 0;
  double quality[kMetrics] = {};
};
using Curve = std::vector<Point>;

Point measure_file(const RgbImage& image, const Bytes& file) {
  const RgbImage decoded = *jpeg::decode(file);
  Point point;
  point.bytes = static_cast<double>(file.size());
  point.quality[0] = psnr_rgb(image.view(), decoded.view());
  point.quality[1] = psnr_luma(image.view(), decoded.view());
  // In dB, so that equal steps mean as much near 1 as elsewhere.
  point.quality[2] = -10.0 * std::log10(1.0 - ssim_luma(image.view(), decoded.view()));
  point.quality[3] = ssimulacra2(image.view(), decoded.view());
  point.quality[4] = psnr_hvs_luma(image.view(), decoded.view()).psnr_hvs_m_db;
  point.quality[5] = -10.0 * std::log10(1.0 - ms_ssim_luma(image.view(), decoded.view()));
  return point;
}

double percent(const Curve& reference, const Curve& test, size_t m) {
  const auto points = [m](const Curve& curve) {
    std::vector<RatePoint> out;
    for (const Point& point : curve) out.push_back({point.bytes, point.quality[m]});
    return out;
  };
  const auto rate = bd_rate(points(reference), points(test));
  return rate.ok() ? rate->percent : std::nan("");
}

Bytes libjpeg_turbo_file(const RgbImage& image, int quality) {
  bench::LibjpegTurbo peer;
  peer.encode(image, quality, true);
  return Bytes(peer.file().begin(), peer.file().end());
}

struct Setting {
  std::string name;
  jpeg::Effort effort;
  jpeg::Tune tune;
};

Curve our_curve(const RgbImage& image, const Setting& setting) {
  Curve curve;
  for (const int quality : kQualities)
    curve.push_back(
        measure_file(image, *jpeg::encode(image.view(), jpeg::options_for(setting.effort, setting.tune, quality))));
  return curve;
}

std::map<std::string, std::vector<double>> g_rates[kMetrics];

void report(const std::string& picture, const std::string& setting, const Curve& reference, const Curve& curve) {
  std::printf("%-24s %-16s", picture.c_str(), setting.c_str());
  for (size_t m = 0; m < kMetrics; ++m) {
    const double rate = percent(reference, curve, m);
    g_rates[m][setting].push_back(rate);
    std::printf("  %s %+6.1f", kMetricNames[m], rate);
  }
  std::printf("\n");
  std::fflush(stdout);
}

// The peer's files beside the picture, by setting.
std::map<std::string, Curve> peer_curves(const std::string& path, const RgbImage& image) {
  std::map<std::string, Curve> curves;
  for (const char* setting : {"moz-default", "moz-flat", "moz-flat-all", "moz-ms-ssim", "moz-psnr-hvs"}) {
    for (const int quality : kQualities) {
      const auto file =
          read_file(path.substr(0, path.rfind('.')) + "." + setting + "." + std::to_string(quality) + ".jpg");
      if (file.ok()) curves[setting].push_back(measure_file(image, *file));
    }
  }
  return curves;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Setting> settings;
  const std::pair<const char*, jpeg::Effort> efforts[] = {{"default", jpeg::Effort::normal},
                                                          {"best", jpeg::Effort::best}};
  const std::pair<const char*, jpeg::Tune> tunes[] = {
      {"psnr", jpeg::Tune::psnr}, {"ssim", jpeg::Tune::ssim}, {"visual", jpeg::Tune::visual}, {"hvs", jpeg::Tune::hvs}};
  for (const auto& [effort_name, effort] : efforts)
    for (const auto& [tune_name, tune] : tunes)
      settings.push_back({std::string(tune_name) + " " + effort_name, effort, tune});
  for (int i = 1; i < argc; ++i) {
    const auto bytes = read_file(argv[i]);
    const Result<RgbImage> image = bytes.ok() ? decode_rgb(*bytes) : bytes.failure();
    if (!image.ok()) {
      std::fprintf(stderr, "%s: %s\n", argv[i], image.failure().text);
      return 1;
    }
    Curve reference;
    for (const int quality : kQualities) reference.push_back(measure_file(*image, libjpeg_turbo_file(*image, quality)));
    const std::string path = argv[i], name = path.substr(path.rfind('/') + 1);
    for (const Setting& setting : settings) report(name, setting.name, reference, our_curve(*image, setting));
    for (const auto& [setting, curve] : peer_curves(path, *image)) report(name, setting, reference, curve);
  }
  std::printf("\nBD-rate %% against libjpeg-turbo with optimal Huffman tables, q15..q90: mean (worst)\n");
  for (const auto& [setting, unused] : g_rates[0]) {
    std::printf("%-16s", setting.c_str());
    for (size_t m = 0; m < kMetrics; ++m) {
      const std::vector<double>& rates = g_rates[m][setting];
      double sum = 0;
      for (const double r : rates) sum += r;
      std::printf("  %s %+6.1f (%+6.1f)", kMetricNames[m], sum / static_cast<double>(rates.size()),
                  *std::max_element(rates.begin(), rates.end()));
    }
    std::printf("\n");
  }
}
