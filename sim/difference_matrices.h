// Quantizer matrices of MPEG-1 for differences.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "mpeg1/mpeg1.h"

namespace pac::sim {

// Eye and metric forgive errors of fine detail; the flat default spends bits on it. Entries 16 (DC) to 58.
inline mpeg1::QuantizerMatrix sloping_matrix(double at_dc, double slope) {
  mpeg1::QuantizerMatrix matrix;
  for (size_t v = 0; v < 8; ++v)
    for (size_t u = 0; u < 8; ++u)
      matrix[8 * v + u] =
          static_cast<uint8_t>(std::clamp(at_dc + slope * static_cast<double>(u + v) + 0.5, 1.0, 255.0));
  return matrix;
}

// D holds H - L at half height: half the quantizer degrades its features as the whole one does H's [Levoy95 s.3]. The
// entry of the intra DC is fixed at 8 [2.4.3.2].
inline mpeg1::QuantizerMatrix halved(mpeg1::QuantizerMatrix matrix) {
  for (uint8_t& entry : matrix) entry = static_cast<uint8_t>(std::max(3, (entry + 1) / 2));
  return matrix;
}

inline mpeg1::QuantizerMatrix halved_intra() {
  mpeg1::QuantizerMatrix matrix = halved(mpeg1::kDefaultIntraMatrix);
  matrix[0] = 8;
  return matrix;
}

}  // namespace pac::sim
