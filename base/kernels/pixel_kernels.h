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

  // All the rows below: any n >= 0 unless said otherwise, any alignment, no overlap of input and output; exactly the
  // named samples are read and written.

  // JFIF's YCbCr [JFIF 1.02 p.3] of n interleaved RGB pixels, 16-bit fixed point as the IJG software rounds it:
  //   y  = ( 19595 r + 38470 g +  7471 b + 32768) >> 16
  //   cb = (-11059 r - 21709 g + 32768 b + 128*65536 + 32767) >> 16
  //   cr = ( 32768 r - 27439 g -  5329 b + 128*65536 + 32767) >> 16     each 0..255 without a clamp.
  void (*ycc_from_rgb_row)(const uint8_t* rgb, size_t n, uint8_t* y, uint8_t* cb, uint8_t* cr);
  // Its inverse, interleaved, clamped to 0..255; with u = cb - 128, v = cr - 128:
  //   r = y + ((91881 v + 32768) >> 16)
  //   g = y + ((-22554 u - 46802 v + 32768) >> 16)
  //   b = y + ((116130 u + 32768) >> 16)
  void (*rgb_from_ycc_row)(const uint8_t* y, const uint8_t* cb, const uint8_t* cr, size_t n, uint8_t* rgb);

  // Two rows to 4:2:0: ycc_from_rgb_row() of both, then downsample_h2v2_row() of their Cb and of their Cr. n counts
  // pixels of a row and is even; cb and cr get n / 2 samples.
  void (*ycc420_from_rgb_rows)(const uint8_t* upper_rgb, const uint8_t* lower_rgb, size_t n, uint8_t* upper_y,
                               uint8_t* lower_y, uint8_t* cb, uint8_t* cr);

  // Box averages; n counts outputs, inputs hold 2n samples. The rounding bias alternates so that it has no drift:
  //   h2v1: out[i] = (in[2i] + in[2i+1] + (i & 1)) >> 1
  //   h2v2: out[i] = (a[2i] + a[2i+1] + b[2i] + b[2i+1] + 1 + (i & 1)) >> 2       (a, b: upper and lower row)
  void (*downsample_h2v1_row)(const uint8_t* in, size_t n, uint8_t* out);
  void (*downsample_h2v2_row)(const uint8_t* a, const uint8_t* b, size_t n, uint8_t* out);

  // Triangle-filter upsampling as the IJG software's "fancy" one: each output is 3/4 the nearer and 1/4 the farther
  // sample, in each direction. n >= 1 counts *inputs*; in[-1] stands for in[0] and in[n] for in[n-1].
  //   h2v1: out[2i] = (3 in[i] + in[i-1] + 1) >> 2,  out[2i+1] = (3 in[i] + in[i+1] + 2) >> 2
  //   h2v2: s[i] = 3 near[i] + far[i];  out[2i] = (3 s[i] + s[i-1] + 8) >> 4,  out[2i+1] = (3 s[i] + s[i+1] + 7) >> 4
  //   h1v2: out[i] = (3 near[i] + far[i] + bias) >> 2, bias 1 (upper output row of the two) or 2 (lower)
  // `near` is the input row that holds the output row, `far` the next one above (upper output row) or below (lower).
  void (*upsample_h2v1_row)(const uint8_t* in, size_t n, uint8_t* out);
  void (*upsample_h2v2_row)(const uint8_t* near, const uint8_t* far, size_t n, uint8_t* out);
  void (*upsample_h1v2_row)(const uint8_t* near, const uint8_t* far, int bias, size_t n, uint8_t* out);

  // A row of 4:2:0 samples to RGB: rgb_from_ycc_row() of what upsample_h2v2_row() makes of Cb and of Cr. n >= 1 counts
  // *pixels*; chroma rows hold (n + 1) / 2 samples.
  void (*rgb_from_ycc420_row)(const uint8_t* y, const uint8_t* cb_near, const uint8_t* cb_far, const uint8_t* cr_near,
                              const uint8_t* cr_far, size_t n, uint8_t* rgb);
};

// One per instruction set: overwrites the entries that it improves.
void fill_pixel_scalar(PixelKernels& table);
void fill_pixel_sse41(PixelKernels& table);
void fill_pixel_avx2(PixelKernels& table);
void fill_pixel_neon(PixelKernels& table);

}  // namespace pac
