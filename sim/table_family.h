// Quantization tables as a function of one real-valued quality: Annex K scaled, or designed for one picture.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/result.h"
#include "jpeg/jpeg.h"
#include "sim/match.h"

namespace pac::sim {

bool same_tables(const jpeg::QuantTables& a, const jpeg::QuantTables& b);

// For one coefficient (natural order) and each step 1..255 (index 0 unused): the squared error of quantizing it in
// all blocks of a picture, and the bits of its levels by their first-order entropy.
struct StepCosts {
  std::array<double, 256> error{}, bits{};
};
struct PictureCosts {
  std::array<StepCosts, 64> luma, chroma;  // chroma: Cb and Cr together
};

// The largest magnitude of each coefficient over all blocks.
struct CoefficientPeaks {
  std::array<double, 64> luma{}, chroma{};
};
CoefficientPeaks measure_peaks(ConstRgbView image, jpeg::Subsampling subsampling);

// Gathers them with a floating-point DCT over the picture's 8x8 blocks (edges replicated). DC counts the bits of
// differences between neighboring blocks, as the codec does. importance: how many times a block's errors count, as
// jpeg::EncodeOptions::importance. Same bits on every machine.
std::unique_ptr<PictureCosts> measure_costs(ConstRgbView image, jpeg::Subsampling subsampling,
                                            std::span<const float> importance = {});

// The family of one picture.
class ScaledTables {
 public:
  // Annex K ignores the picture. For `adapted`, tables(q) holds for each coefficient the step that minimizes
  // error + lambda * bits [Ratnakar and Livny 1995, RD-OPT], where lambda = ln 2 / 6 * step^2 is the slope at which a
  // fine quantizer of that step trades error for bits, and step = 0.16 s: 16, Annex K's first luma step, at scale 100.
  // So halving s halves the steps of both families, which is what the notations of quality in sim/match.h rest on.
  // importance: as measure_costs, of `adapted`.
  static Result<ScaledTables> create(ConstRgbView image, TableFamily family, jpeg::Subsampling subsampling,
                                     std::span<const float> importance = {});

  // quality in (0, 100].
  jpeg::QuantTables at_quality(double quality) const;

  // One quality for each pair of tables that can make another file of this picture (adapted: on a grid of scales 0.2 %
  // apart), finest tables first. Steps that only change entries too coarse to leave any level but zero are one step.
  std::vector<double> step_qualities() const;

 private:
  std::shared_ptr<const PictureCosts> costs_;  // null: Annex K
  CoefficientPeaks peaks_;                     // Annex K only
};

}  // namespace pac::sim
