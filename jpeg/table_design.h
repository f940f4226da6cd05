// Quantization tables made for an image [Ratnakar, Livny: RD-OPT, DCC 1995].
#pragma once

#include <cstdint>
#include <vector>

#include "jpeg/coefficients.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

// Histograms of the DCT coefficients of an image, for each frequency, of luma and of both chroma components together.
class TableDesigner {
 public:
  static constexpr int kKinds = 7;  // of blocks, by activity

  // Forgets the last image.
  void reset();
  // Adds MCU rows; bands of an image in order.
  void add_rows(CoefficientSource& source, int first_row, int end_row);
  // For each frequency the step with the least bits + kBitsPerSquaredStep * sum((error / reference)^2), the reference
  // being tuned_reference(tune, quality) and the bits the entropy of the levels at that frequency.
  QuantTables at_quality(Tune tune, double quality) const;

 private:
  // Magnitudes in units of half a coefficient: fine enough for step 1.
  static constexpr int kBins = 2 * 1024 + 64;
  struct Histograms {
    std::vector<uint32_t> counts[kKinds];  // [64 natural][kBins]
    int n_bins[kKinds][64] = {};           // beyond: zeros
    uint64_t n_blocks = 0;
    void reset();
  };
  void add(const int16_t* coefficients, size_t n_blocks, int& dc, Histograms& to) const;
  double cost(const Histograms& of, size_t natural, int step, double reference) const;
  uint16_t best_step(const Histograms& of, size_t natural, double reference) const;

  Histograms luma_, chroma_;
  int dc_[3] = {0, 0, 0};  // of the block before
};

}  // namespace pac::jpeg
