// Quantization tables made for an image [Ratnakar, Livny: RD-OPT, DCC 1995].
#pragma once

#include <cstdint>
#include <vector>

#include "jpeg/coefficients.h"
#include "jpeg/jpeg.h"
#include "jpeg/tables.h"

namespace pac::jpeg {

// Steps of DC, from the values that it takes and the differences that are coded. Flat areas share one value, and a step
// that meets it takes the error of all of them away.
class DcDesigner {
 public:
  void reset();
  void add(const int16_t* coefficients, size_t n_blocks, int& dc);
  void finish();
  // The step with the least bits + bits_per_squared_step * sum((error / reference)^2).
  uint16_t best_step(double reference, double bits_per_squared_step) const;

 private:
  // Values and magnitudes of differences in units of an eighth of a sample, which is one unit of the DCT.
  static constexpr int kRange = 1040;
  // Of all magnitudes below one: how many there are, their sum and their squares' sum.
  struct Below {
    int64_t count, sum, squares;
  };
  double cost(int step, double weight) const;

  std::vector<uint32_t> value_counts_, difference_counts_;
  std::vector<Below> values_below_, differences_below_;  // up to behind the largest magnitude
};

// Histograms of the AC coefficients of an image, for each frequency and each of some kinds of blocks.
class AcDesigner {
 public:
  void reset();
  void add(const int16_t* coefficients, size_t n_blocks);
  void finish();
  // The step of frequency `natural` (1..63) with the least bits + bits_per_squared_step * sum((error / reference)^2),
  // the bits being the entropy of its levels. Coefficients count multiplied by `gain`.
  uint16_t best_step(size_t natural, double reference, double gain, double bits_per_squared_step) const;

 private:
  static constexpr int kKinds = 7;    // of blocks, by activity
  static constexpr int kBins = 1024;  // magnitudes in units of half a coefficient; larger ones count as the largest
  // Of all coefficients below a bin: how many there are, their magnitudes' sum and squares' sum.
  struct Below {
    double count, sum, squares;
  };
  double cost(size_t natural, int step, double reference, double gain, double bits_per_squared_step) const;

  std::vector<uint16_t> counts_;  // [kKinds][64 natural][kBins]
  uint16_t n_bins_[kKinds][64] = {};
  std::vector<Below> below_;
  uint32_t first_below_[kKinds][64] = {};
};

class TableDesigner {
 public:
  // Forgets the last image. dc_only: dc_at_quality() will be asked for, not at_quality().
  void reset(bool dc_only);
  // MCU rows of an image in order, all of them or a sample.
  void add_row(CoefficientSource& source, int mcu_row);
  void finish();
  // All steps chosen for the reference tuned_reference(tune, quality).
  QuantTables at_quality(Tune tune, double quality, const double (&chroma_gain)[64]) const;
  // tuned_tables(tune, quality) but for DC.
  QuantTables dc_at_quality(Tune tune, double quality) const;

 private:
  bool dc_only_ = false, has_chroma_ = false;
  DcDesigner dc_[2];  // of luma, of both chroma components together
  AcDesigner ac_[2];
  int last_dc_[3] = {0, 0, 0};
};

}  // namespace pac::jpeg
