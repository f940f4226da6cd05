// Makes the constants of jpeg/difference_tables.cpp: Huffman tables for difference images, known before any is seen.
//   train_difference_huffman > jpeg/difference_tables.cpp
// Counts the symbols of difference images of the built-in scenes, made from other seeds and other cameras of their
// paths than anything that is reported (seed 1, frames 0 to 47), at several qualities with Annex K's and with tuned
// tables. Every picture at every quality counts as much as any other, however many symbols it has. Progress goes to
// stderr.
#include <cstdint>
#include <cstdio>

#include "jpeg/general_strip.h"
#include "jpeg/huffman.h"
#include "jpeg/image_encoder.h"
#include "jpeg/jpeg.h"
#include "sim/experiment.h"

namespace {

using namespace pac;

constexpr uint32_t kSeeds[] = {2, 3};
constexpr int kFrames[] = {97, 171, 263};
constexpr double kQualities[] = {20, 30, 41, 55, 75};

struct Totals {
  uint64_t count[jpeg::kTableCount][256] = {};
};

// Histograms scaled to a sum of about 2^32, so that each weighs the same.
void add(const jpeg::Histogram& histogram, Totals& totals) {
  constexpr uint64_t kWeight = uint64_t{1} << 32;
  uint64_t n = 0;
  for (const auto& table : histogram.count)
    for (const uint32_t count : table) n += count;
  if (n == 0) return;
  for (size_t table = 0; table < jpeg::kTableCount; ++table)
    for (size_t symbol = 0; symbol < 256; ++symbol)
      totals.count[table][symbol] += histogram.count[table][symbol] * (kWeight / n);
}

void count_picture(const RgbImage& difference, Totals& totals) {
  jpeg::ImageEncoder encoder;
  for (const bool is_tuned : {false, true}) {
    for (const double quality : kQualities) {
      jpeg::EncodeOptions options;
      options.quality = quality;
      options.tables = is_tuned ? jpeg::tuned_tables(jpeg::Tune::psnr, quality) : jpeg::annex_k_tables(quality);
      encoder.start(jpeg::rgb_image(difference.view()), options, false);
      add(encoder.count_symbols(*options.tables, quality), totals);
    }
  }
}

bool count_scene(const sim::BuiltinScene& builtin, Totals& totals) {
  for (const uint32_t seed : kSeeds) {
    const sim::SceneSet set = builtin.build(seed);
    const float aspect = static_cast<float>(set.width) / static_cast<float>(set.height);
    for (const int frame : kFrames) {
      const auto pictures = sim::render_split(set, builtin.camera(frame, aspect), {});
      if (!pictures.ok()) {
        std::fprintf(stderr, "%s: %s\n", builtin.name, pictures.failure().text);
        return false;
      }
      count_picture(pictures->difference, totals);
      std::fprintf(stderr, "%s, seed %u, frame %d\n", builtin.name, seed, frame);
    }
  }
  return true;
}

void print_spec(const char* name, const jpeg::HuffmanSpec& spec) {
  std::printf("constexpr HuffmanSpec %s = {{0", name);
  for (int length = 1; length <= jpeg::kMaxCodeLength; ++length) std::printf(", %d", spec.count[length]);
  std::printf("},\n {");
  const int n = spec.n_symbols();
  for (int i = 0; i < n; ++i) std::printf("%s0x%02x", i == 0 ? "" : ", ", spec.symbols[i]);
  std::printf("}};\n\n");
}

}  // namespace

int main() {
  Totals totals;
  for (const sim::BuiltinScene& builtin : sim::builtin_scenes())
    if (!count_scene(builtin, totals)) return 1;
  std::printf(
      "// Huffman tables for difference images, made by bench/training/difference_huffman.cpp from scenes and cameras\n"
      "// that nothing reports. Every symbol of a baseline file has a code.\n"
      "#include \"jpeg/tables.h\"\n\nnamespace pac::jpeg {\nnamespace {\n\n");
  constexpr const char* kNames[jpeg::kTableCount] = {"kDcLuma", "kAcLuma", "kDcChroma", "kAcChroma"};
  for (uint32_t table = 0; table < jpeg::kTableCount; ++table)
    print_spec(kNames[table], jpeg::complete_huffman(table == jpeg::kDc0 || table == jpeg::kDc1, totals.count[table]));
  std::printf(
      "}  // namespace\n\nconst HuffmanSpec& difference_dc(int table) {\n  return table == 0 ? kDcLuma : "
      "kDcChroma;\n}\n\n"
      "const HuffmanSpec& difference_ac(int table) {\n  return table == 0 ? kAcLuma : kAcChroma;\n}\n\n"
      "}  // namespace pac::jpeg\n");
}
