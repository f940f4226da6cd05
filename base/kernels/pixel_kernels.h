// Row-wise pixel operations: RGB <-> YCbCr, chroma down- and upsampling, difference image and composite.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

struct PixelKernels {
  // d[i] = 127 + trunc((h[i] - l[i]) / 2): the paper's difference image [Levoy95 s.3], per sample, rounded toward zero
  // as C divides: 0..254 without a clamp, and no bias of sign. Any n and alignment; d may be h or l.
  void (*difference_row)(const uint8_t* h, const uint8_t* l, uint8_t* d, size_t n);
  // c[i] = clamp(l[i] + 2 * (d[i] - 127), 0, 255): the client's inverse of it.
  void (*composite_row)(const uint8_t* l, const uint8_t* d, uint8_t* c, size_t n);
};

// One per instruction set: overwrites the entries that it improves.
void fill_pixel_scalar(PixelKernels& table);
void fill_pixel_sse41(PixelKernels& table);
void fill_pixel_avx2(PixelKernels& table);
void fill_pixel_neon(PixelKernels& table);

}  // namespace pac
