#include "sim/quantizer_adaptation.h"

#include <algorithm>
#include <cmath>

#include "base/exact_math.h"
#include "mpeg1/mpeg1.h"
#include "sim/object_motion.h"

namespace pac::sim {

namespace {

constexpr double kLeastWorth = 1.0 / 16, kGreatestWorth = 16;
constexpr int kSide = 16;  // of a macroblock

// Of each of the scene's materials: is it named? Empty where a name is none of them.
std::vector<uint8_t> named_materials(const raster::Scene& scene, const std::vector<std::string>& names) {
  std::vector<uint8_t> named(scene.materials.size());
  for (const std::string& name : names) {
    bool is_known = false;
    for (size_t i = 0; i < named.size(); ++i)
      if (scene.materials[i].name == name) named[i] = 1, is_known = true;
    if (!is_known) return {};
  }
  return named;
}

// Four times the luma of a pixel, or nearly so.
int64_t luma_of(const uint8_t* rgb) {
  return rgb[0] + 2 * rgb[1] + rgb[2];
}

// Variance of luma of the 8x8 pixels from (left, top) on, as far as the picture reaches; 0 outside.
double variance(ConstRgbView high, int left, int top) {
  const int right = std::min(left + 8, high.width), bottom = std::min(top + 8, high.height);
  if (left >= right || top >= bottom) return 0;
  int64_t sum = 0, squares = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const int64_t luma = luma_of(high.pixel(x, y));
      sum += luma;
      squares += luma * luma;
    }
  const int64_t n = int64_t{right - left} * (bottom - top);
  return static_cast<double>(n * squares - sum * sum) / (16.0 * static_cast<double>(n * n));
}

}  // namespace

void read_foreground(std::string_view names, Foreground& foreground) {
  while (!names.empty()) {
    const std::string_view name = names.substr(0, names.find(','));
    names.remove_prefix(std::min(name.size() + 1, names.size()));
    if (name == "moving")
      foreground.moving = true;
    else if (!name.empty())
      foreground.materials.emplace_back(name);
  }
}

Result<std::vector<float>> worth_of_ids(const raster::Scene& scene, const Foreground& foreground) {
  std::vector<float> worth;
  if (!foreground.is_on()) return worth;
  if (!(foreground.worth >= kLeastWorth && foreground.worth <= kGreatestWorth))
    return Failure{Error::bad_argument, 0, "the foreground's worth is outside 1/16..16"};
  const std::vector<uint8_t> named = named_materials(scene, foreground.materials);
  if (named.size() != scene.materials.size())
    return Failure{Error::bad_argument, 0, "the model has no such material for a foreground"};
  const std::vector<uint32_t> movers = movers_of(scene);
  worth.assign(scene.mesh.faces.size() + 1, 1.0F);
  for (size_t face = 0; face < scene.mesh.faces.size(); ++face) {
    const bool moves = foreground.moving && !movers.empty() && movers[face + 1] != kStands;
    if (moves || named[scene.mesh.faces[face].material] != 0) worth[face + 1] = static_cast<float>(foreground.worth);
  }
  return worth;
}

Result<QuantizerAdaptation> QuantizerAdaptation::create(const raster::Scene& low, const Foreground& foreground) {
  QuantizerAdaptation out;
  PAC_TRY(out.worth_, worth_of_ids(low, foreground));
  return out;
}

// Errors of a macroblock are the less visible the more it varies: kMasking is the exponent of its variance. What the
// picture needs on the mean stays as it is.
void QuantizerAdaptation::mask(ConstRgbView high) {
  constexpr double kMasking = 0.05, kNoise = 4;  // of variance, that is as smooth as no variance at all
  std::vector<double> logarithms;
  double mean = 0;
  for (int top = 0; top < high.height; top += kSide)
    for (int left = 0; left < high.width; left += kSide) {
      double sum = 0;
      for (int block = 0; block < 4; ++block) sum += variance(high, left + 8 * (block & 1), top + 8 * (block >> 1));
      logarithms.push_back(exact_log(sum / 4 + kNoise));
      mean += logarithms.back();
    }
  mean /= static_cast<double>(logarithms.size());
  for (size_t i = 0; i < logarithms.size(); ++i)
    factors_[i] = static_cast<float>(exact_exp(kMasking * (logarithms[i] - mean)));
}

// At high rate distortion + lambda * bits is least where quantizer_scale goes as the inverse root of what an error
// counts; of a macroblock that is the mean over its pixels.
void QuantizerAdaptation::weigh(PlaneView<const uint32_t> id) {
  size_t i = 0;
  for (int top = 0; top < id.height; top += kSide)
    for (int left = 0; left < id.width; left += kSide) {
      const int right = std::min(left + kSide, id.width), bottom = std::min(top + kSide, id.height);
      float sum = 0;
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) {
          const uint32_t shown = id.row(y)[x];
          sum += shown < worth_.size() ? worth_[shown] : 1.0F;
        }
      factors_[i] /= std::sqrt(sum / static_cast<float>((right - left) * (bottom - top)));
      ++i;
    }
}

std::span<const float> QuantizerAdaptation::factors(ConstRgbView high, PlaneView<const uint32_t> id, bool masks) {
  if (!masks && worth_.empty()) return {};
  const int count = mpeg1::macroblock_columns(high.width) * mpeg1::macroblock_rows(high.height);
  factors_.assign(static_cast<size_t>(count), 1.0F);
  if (masks) mask(high);
  if (!worth_.empty()) weigh(id);
  for (float& factor : factors_) factor = std::clamp(factor, 0.0625F, 16.0F);
  return factors_;
}

}  // namespace pac::sim
