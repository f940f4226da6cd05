// Quantizer matrices that suit the coefficients which a sequence has had so far.
#pragma once

#include <cstdint>
#include <vector>

#include "mpeg1/mpeg1.h"
#include "mpeg1/residual_coder.h"

namespace pac::mpeg1 {

// How large the coefficients of coded blocks were, in multiples of their quantizer_scale.
class CoefficientStatistics {
 public:
  CoefficientStatistics();
  // The coded blocks of a macroblock.
  void add(const Attempt& attempt);
  void add(const CoefficientStatistics& other);
  void clear();

  static constexpr int kBins = 80;  // of two units each; coefficients are scaled by 8: 16 units are the default step
  struct Histogram {
    uint32_t n_blocks = 0;
    uint32_t counts[64][kBins] = {};  // [zigzag position]
  };
  const Histogram& of(bool is_intra) const { return histograms_[is_intra ? 1 : 0]; }

 private:
  std::vector<Histogram> histograms_;  // non-intra, intra
};

// Each entry by least distortion + lambda * bits over the histogram, where bits are those of the codes after a run of
// ordinary length. lambda: of quantizer_scale 1. Returns `matrix` where there are too few blocks, or too little is
// gained to be worth 64 bytes.
QuantizerMatrix adapted_matrix(const CoefficientStatistics& statistics, const QuantizerMatrix& matrix, bool is_intra,
                               int64_t lambda);

// `matrix` times scale, entries kMinMatrixEntry..255, the first one of intra left at 8.
QuantizerMatrix scaled_matrix(const QuantizerMatrix& matrix, double scale, bool is_intra);

}  // namespace pac::mpeg1
