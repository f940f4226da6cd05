// `pac metrics`: how far a picture, or a sequence, is from its reference.
#include "base/metrics.h"

#include <cstdio>

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
  for (const Row& row : rows) std::printf("%-22s %.*f\n", row.label, row.digits, row.value);
}

int report(const Options& options, ConstRgbView reference, ConstRgbView test) {
  const Metrics metrics = measure(reference, test);
  const Row rows[] = {
      {"rms", "rms (levels)", metrics.rms, 4},
      {"psnr_rgb_db", "PSNR, RGB (dB)", metrics.psnr_rgb_db, 3},
      {"psnr_luma_db", "PSNR, luma (dB)", metrics.psnr_luma_db, 3},
      {"ssim", "SSIM, luma", metrics.ssim, 5},
      {"ms_ssim", "MS-SSIM, luma", metrics.ms_ssim, 5},
      {"max_error", "largest error (levels)", static_cast<double>(metrics.max_error), 0},
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

int compare_pictures(const Options& options, const NamedBytes& reference, const NamedBytes& test,
                     const std::string& map_path, int gain) {
  const auto first = decode_picture(reference.bytes, options.isa);
  if (!first.ok()) return data_error(reference.path, first.failure());
  const auto second = decode_picture(test.bytes, options.isa);
  if (!second.ok()) return data_error(test.path, second.failure());
  if (first->empty() || first->width() != second->width() || first->height() != second->height())
    return data_error(test.path, std::string("is ") + size_text(*second) + " pixels, but " + reference.path + " is " +
                                     size_text(*first));
  if (!map_path.empty()) {
    const RgbImage map = error_map(first->view(), second->view(), gain);
    if (const int code = write_picture(map_path, map.view()); code != kDone) return code;
  }
  return report(options, first->view(), second->view());
}

}  // namespace

int run_metrics(Args args) {
  Options options("metrics", "how far a picture or sequence is from its reference",
                  "pac metrics room.png room-decoded.png --map error.png");
  std::string reference_path, test_path, map_path;
  int gain = 8;
  options.positional("REFERENCE", reference_path, "PNG, PPM, PGM or JPEG; or a Y4M sequence");
  options.positional("TEST", test_path, "of the same size");
  options.text("--map", "OUT.png", map_path, "a picture of where the error is: |difference| * gain");
  options.integer("--gain", "N", gain, 1, 255, "of the map (8)");
  if (const auto code = options.parse(args)) return *code;
  if (reference_path == "-" && test_path == "-") return options.usage_error("only one of the two can be stdin");
  if (!map_path.empty())
    if (const std::string problem = picture_name_problem(map_path); !problem.empty())
      return options.usage_error(problem);
  if (map_path == "-") return options.usage_error("--map needs a file: stdout holds the figures");

  NamedBytes reference{reference_path, {}}, test{test_path, {}};
  for (NamedBytes* input : {&reference, &test}) {
    auto bytes = read_file(input->path);
    if (!bytes.ok()) return data_error(input->path, bytes.failure());
    input->bytes = std::move(bytes).value();
  }
  if (!is_y4m(reference.bytes) || !is_y4m(test.bytes))
    return compare_pictures(options, reference, test, map_path, gain);
  if (!map_path.empty()) return options.usage_error("--map is for pictures, not for sequences");
  return compare_sequences(options, reference, test);
}

}  // namespace pac::cli
