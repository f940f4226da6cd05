// `pac metrics`: how far a picture, or a sequence, is from its reference.
#include "base/metrics.h"

#include <cstdio>

#include "base/cambi.h"
#include "base/flip.h"
#include "base/parallel.h"
#include "sim/cli/image_files.h"
#include "sim/cli/metrics.h"

namespace pac::cli {
namespace {

struct Row {
  const char* key;
  const char* label;
  double value;
  int digits;
};

void print_rows(std::span<const Row> rows) {
  for (const Row& row : rows) std::printf("%-24s %.*f\n", row.label, row.digits, row.value);
}

int report(const Options& options, ConstRgbView reference, ConstRgbView test) {
  ThreadPool pool(options.threads);
  const Metrics metrics = measure(reference, test, &pool);
  const Row rows[] = {
      {"rms", "rms (levels)", metrics.rms, 4},
      {"psnr_rgb_db", "PSNR, RGB (dB)", metrics.psnr_rgb_db, 3},
      {"psnr_luma_db", "PSNR, luma (dB)", metrics.psnr_luma_db, 3},
      {"psnr_hvs_db", "PSNR-HVS (dB)", metrics.psnr_hvs_db, 3},
      {"psnr_hvs_m_db", "PSNR-HVS-M (dB)", metrics.psnr_hvs_m_db, 3},
      {"ssim", "SSIM, luma", metrics.ssim, 5},
      {"ms_ssim", "MS-SSIM, luma", metrics.ms_ssim, 5},
      {"ssimulacra2", "SSIMULACRA 2.1", metrics.ssimulacra2, 3},
      {"flip", "FLIP, mean", metrics.flip, 5},
      {"max_error", "largest error (levels)", static_cast<double>(metrics.max_error), 0},
      {"reference_cambi", "banding of reference", cambi_luma(reference), 3},
      {"test_cambi", "banding of test (CAMBI)", cambi_luma(test), 3},
      {"reference_entropy_luma", "entropy of reference", entropy_luma(reference), 3},
      {"test_entropy_luma", "entropy of test", entropy_luma(test), 3},
  };
  if (!options.json) {
    print_rows(rows);
    return kDone;
  }
  sim::JsonWriter json;
  json.begin_object();
  json.field("width", reference.width);
  json.field("height", reference.height);
  for (const Row& row : rows) json.field(row.key, row.value);
  json.end_object();
  return print_json(json);
}

std::string size_text(const RgbImage& image) {
  return std::to_string(image.width()) + "x" + std::to_string(image.height());
}

enum class MapKind : uint8_t { flip, difference };

struct MapRequest {
  std::string path;  // empty: none
  MapKind kind = MapKind::flip;
  int gain = 8;
};

int write_map(const Options& options, const MapRequest& request, ConstRgbView reference, ConstRgbView test) {
  if (request.kind == MapKind::difference)
    return write_picture(request.path, error_map(reference, test, request.gain).view());
  ThreadPool pool(options.threads);
  return write_picture(request.path, magma_picture(flip_map(reference, test, &pool)).view());
}

int compare_pictures(const Options& options, const NamedBytes& reference, const NamedBytes& test,
                     const MapRequest& map) {
  const auto first = decode_picture(reference.bytes, options.isa);
  if (!first.ok()) return data_error(reference.path, first.failure());
  const auto second = decode_picture(test.bytes, options.isa);
  if (!second.ok()) return data_error(test.path, second.failure());
  if (first->empty() || first->width() != second->width() || first->height() != second->height())
    return data_error(test.path, std::string("is ") + size_text(*second) + " pixels, but " + reference.path + " is " +
                                     size_text(*first));
  if (!map.path.empty())
    if (const int code = write_map(options, map, first->view(), second->view()); code != kDone) return code;
  return report(options, first->view(), second->view());
}

}  // namespace

int run_metrics(Args args) {
  Options options("metrics", "how far a picture or sequence is from its reference",
                  "pac metrics room.png room-decoded.png --map error.png");
  std::string reference_path, test_path;
  MapRequest map;
  options.positional("REFERENCE", reference_path, "PNG, PPM, PGM or JPEG; or a Y4M sequence");
  options.positional("TEST", test_path, "of the same size");
  options.text("--map", "OUT.png", map.path, "a picture of where the error is");
  options.choice<MapKind>("--map-of", map.kind, {{"flip", MapKind::flip}, {"difference", MapKind::difference}},
                          "FLIP in the colors magma (flip), or |difference| * gain");
  options.integer("--gain", "N", map.gain, 1, 255, "of the map of the difference (8)");
  if (const auto code = options.parse(args)) return *code;
  if (reference_path == "-" && test_path == "-") return options.usage_error("only one of the two can be stdin");
  if (!map.path.empty())
    if (const std::string problem = picture_name_problem(map.path); !problem.empty())
      return options.usage_error(problem);
  if (map.path == "-") return options.usage_error("--map needs a file: stdout holds the figures");

  NamedBytes reference{reference_path, {}}, test{test_path, {}};
  for (NamedBytes* input : {&reference, &test}) {
    auto bytes = read_file(input->path);
    if (!bytes.ok()) return data_error(input->path, bytes.failure());
    input->bytes = std::move(bytes).value();
  }
  if (!is_y4m(reference.bytes) || !is_y4m(test.bytes)) return compare_pictures(options, reference, test, map);
  if (!map.path.empty()) return options.usage_error("--map is for pictures, not for sequences");
  return compare_sequences(options, reference, test);
}

}  // namespace pac::cli
