// Which blocks of a still the renderer's knowledge and the application's hints make more important, and that errors go
// elsewhere at equal bytes.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/edge_band.h"
#include "sim/block_importance.h"
#include "sim/experiment.h"
#include "sim/table_family.h"
#include "tests/support/run_cli.h"

namespace {

using namespace pac;
using sim::BlockClass;

constexpr int kSide = 256, kColumns = kSide / 8;
constexpr const char* kHinted = "tartan";

const sim::SceneSet& cubes() {
  static const sim::SceneSet scene = sim::find_scene("cubes")->build(1);
  return scene;
}

sim::Renderings draw(const sim::ImportanceOptions& importance) {
  sim::RenderOptions options;
  options.split = "texture";
  options.width = options.height = kSide;
  options.samples = 4;
  options.find_blocks = true;
  options.importance = importance;
  auto renderings = sim::render_split(cubes(), sim::find_scene("cubes")->camera(0, 1), options);
  REQUIRE(renderings.ok());
  return std::move(*renderings);
}

sim::ImportanceOptions weights(const char* text) {
  sim::ImportanceOptions options;
  REQUIRE(sim::read_class_weights(text, options.of_class).ok());
  return options;
}

IdImage ids() {
  auto renderer = raster::Renderer::create(kSide, kSide);
  IdImage id(kSide, kSide);
  REQUIRE(renderer->render(cubes().fine, sim::find_scene("cubes")->camera(0, 1), {}, {{}, {}, id.view()}).ok());
  return id;
}

bool is_hinted(uint32_t id) {
  const raster::Scene& scene = cubes().fine;
  return id > 0 && scene.materials[scene.mesh.faces[id - 1].material].name == kHinted;
}

TEST_CASE("a block with both cube and background is a silhouette, one within a face is what the face's material is") {
  const IdImage id = ids();
  const std::vector<BlockClass> classes = draw({}).blocks.classes;
  REQUIRE(classes.size() == size_t{kColumns} * kColumns);
  int counts[3] = {};
  for (int block = 0; block < kColumns * kColumns; ++block) {
    const int left = 8 * (block % kColumns), top = 8 * (block / kColumns);
    // With the pixels around, to which an edge may lie.
    bool is_one = true, has_background = false, has_cube = false;
    const uint32_t first = *id.pixel(left, top);
    for (int y = std::max(top - 1, 0); y < std::min(top + 9, kSide); ++y)
      for (int x = std::max(left - 1, 0); x < std::min(left + 9, kSide); ++x) {
        const bool is_inside = x >= left && x < left + 8 && y >= top && y < top + 8;
        is_one = is_one && *id.pixel(x, y) == first;
        if (is_inside) (*id.pixel(x, y) == 0 ? has_background : has_cube) = true;
      }
    const BlockClass found = classes[static_cast<size_t>(block)];
    counts[0] += has_background && has_cube;
    counts[1] += is_one && first == 0;
    counts[2] += is_one && first != 0;
    if (has_background && has_cube) CHECK(found == BlockClass::silhouette);
    if (!is_one) continue;
    const bool is_surface = found == BlockClass::textured || found == BlockClass::specular;
    CHECK((first == 0 ? found == BlockClass::flat : is_surface));
  }
  for (const int count : counts) CHECK(count > 5);
  CHECK(std::ranges::count(classes, BlockClass::edge) > 5);
}

sim::CodingOptions coding() {
  sim::CodingOptions options;
  options.tables = sim::TableFamily::adapted;
  options.huffman = jpeg::Huffman::optimal;
  options.masking = jpeg::Tune::visual;
  return options;
}

// Within the mask, elsewhere.
std::array<double, 2> errors(const sim::Renderings& pictures, sim::ArmKind kind, const GrayImage& mask) {
  const auto arm = sim::code_arm_at_size(pictures, kind, 6000, coding());
  REQUIRE(arm.ok());
  REQUIRE(arm->image_bytes == doctest::Approx(6000).epsilon(0.01));
  GrayImage rest(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) *rest.pixel(x, y) = *mask.pixel(x, y) == 0 ? 255 : 0;
  const ConstRgbView high = pictures.high.view();
  return {masked_rms(high, arm->shown.view(), mask.view()).rms, masked_rms(high, arm->shown.view(), rest.view()).rms};
}

TEST_CASE("at the same bytes edges are nearer to H where their weight is greater, and the rest is farther") {
  const sim::Renderings alike = draw({}), weighted = draw(weights("edge=8,silhouette=8"));
  for (const auto kind : {sim::ArmKind::image_based, sim::ArmKind::polygon_assisted}) {
    const auto before = errors(alike, kind, alike.blocks.edge_band);
    const auto after = errors(weighted, kind, alike.blocks.edge_band);
    CHECK(after[0] < 0.96 * before[0]);
    CHECK(after[1] > before[1]);
  }
}

TEST_CASE("at the same bytes a foreground of the application is nearer to H in both arms") {
  const IdImage id = ids();
  GrayImage mask(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) *mask.pixel(x, y) = is_hinted(*id.pixel(x, y)) ? 255 : 0;
  sim::ImportanceOptions hinted;
  hinted.foreground = {{kHinted}, false, 8};
  const sim::Renderings alike = draw({}), first = draw(hinted);
  for (const auto kind : {sim::ArmKind::image_based, sim::ArmKind::polygon_assisted}) {
    const auto before = errors(alike, kind, mask), after = errors(first, kind, mask);
    CHECK(after[0] < 0.95 * before[0]);
  }
  hinted.foreground.materials = {"velvet"};
  sim::RenderOptions options;
  options.importance = hinted;
  CHECK(!sim::render_split(cubes(), sim::find_scene("cubes")->camera(0, 1), options).ok());
}

TEST_CASE("tables follow the blocks that count: where only smooth ones do, fine textures are quantized coarser") {
  // Left half smooth, right half fine stripes.
  RgbImage image(128, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x)
      for (int c = 0; c < 3; ++c)
        image.pixel(x, y)[c] = static_cast<uint8_t>(x < 64 ? 80 + x / 2 + y / 4 : 90 + 12 * ((x + y * 3) % 5) + y % 7);
  const auto steps = [&](float left, float right) {
    std::vector<float> importance;
    for (int i = 0; i < 16 * 8; ++i) importance.push_back(i % 16 < 8 ? left : right);
    const auto family = sim::ScaledTables::create(image.view(), sim::TableFamily::adapted, jpeg::Subsampling::yuv420,
                                                  left == 0 ? std::vector<float>() : importance);
    REQUIRE(family.ok());
    return family->at_quality(50);
  };
  const auto high_frequencies = [](const jpeg::QuantTables& tables) {
    int sum = 0;
    for (size_t k = 8; k < 64; ++k) sum += tables.luma[k];
    return sum;
  };
  CHECK(sim::same_tables(steps(0, 0), steps(1, 1)));
  CHECK(high_frequencies(steps(1.95F, 0.05F)) > high_frequencies(steps(1, 1)));
}

TEST_CASE("weights of classes are read by name, and what is none is refused") {
  std::array<double, sim::kBlockClasses> of_class = {1, 1, 1, 1, 1};
  CHECK(sim::read_class_weights("edge=2,flat=0.5", of_class).ok());
  CHECK(of_class == std::array<double, sim::kBlockClasses>{0.5, 1, 1, 2, 1});
  CHECK(sim::read_class_weights("", of_class).ok());
  for (const char* wrong : {"edges=2", "edge", "edge=", "edge=x", "edge=2x", "edge=17", "edge=0", "=2", "edge=nan"}) {
    CAPTURE(wrong);
    CHECK(!sim::read_class_weights(wrong, of_class).ok());
  }
}

TEST_CASE("pac compare takes weights and a foreground, with adapted tables only") {
  const test::CliFolder folder;
  const std::string small = "compare cubes --width 64 --height 64 --samples 1 --bytes 1500 ";
  const auto plain = folder.pac(small + "--tables adapted --json");
  const auto weighted = folder.pac(small + "--tables adapted --weights edge=4,silhouette=4 --json");
  CHECK(plain.code == 0);
  CHECK(weighted.code == 0);
  CHECK(weighted.out.find("edge_band_rms") != std::string::npos);
  CHECK(plain.out != weighted.out);
  CHECK(folder.pac(small + "--tables adapted --foreground tartan --worth 8").code == 0);
  CHECK(folder.pac(small + "--tables adapted --foreground velvet").code == 1);
  CHECK(folder.pac(small + "--weights edge=4").code == 2);
  CHECK(folder.pac(small + "--foreground tartan").code == 2);
  CHECK(folder.pac(small + "--tables adapted --weights edge").code == 2);
  CHECK(folder.pac(small + "--tables adapted --worth 8").code == 2);
}

}  // namespace
