// Reprojection: where the content of a pixel was in the frame before, and picking it up there by a 6x6 filter.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

// One row of pixels in homogeneous coordinates of the earlier window. With u = 1 - depth (window z), pixel i has
//   c = (origin[c] + i * per_pixel[c]) + u * per_depth[c]      in float, in this order, for c = x, y, u, w
// and lay at (x / w, y / w) in 1/64 pixel, at 1 - depth = u / w. The terms of w have one sign, so that nothing cancels.
struct ReprojectionRow {
  float origin[4], per_pixel[4], per_depth[4];
};

constexpr int kWarpTaps = 6;  // of the filter, in each direction: at -2 .. +3 from the position's floor
constexpr int kWarpTapsBefore = 2;
constexpr int kWarpPhases = 64;    // a pixel
constexpr int kWarpTapStride = 8;  // coefficients of one phase in the table; the last two are 0
constexpr int32_t kWarpNowhere = INT32_MIN;
constexpr int kCarriedBits = 5;  // of carried differences below the point
constexpr int16_t kLargestCarried = 255 << kCarriedBits;

// What a pixel shows, in 32 bits: bits 16..31 what moves it (modulo 2^16), bits 0..13 its depth (surface_keys_row), and
// in maps of the frame before bit 14: the taps of the filter around a place between this pixel and the next ones all
// show what it shows.
constexpr uint32_t kKeyBits = 0xFFFF3FFF, kKeySurfaceBits = 0xFFFF0000, kKeySmooth = 0x4000;
// Two pixels belong together where their keys, kKeyBits of them, differ by no more: the same surface, and u = 1 - depth
// within 5 to 9 % of each other. The code of a depth is 7 bits of mantissa below its exponent, so that its steps follow
// u.
constexpr int32_t kKeyTolerance = 12;

// The keys of the frame before; those within 5 of its sides can be read and are 0, and reading on behind a row ends in
// the rows below.
struct KeyMap {
  const uint32_t* keys;  // of pixel (0, 0)
  ptrdiff_t stride;
  int32_t width, height;
};

// Where pixels were in the frame before, and how they are found there. Arrays of n.
struct WarpPlaces {
  int32_t *x_64, *y_64;
  uint8_t* state;    // kWarpPlain, kWarpEdge or kWarpAbsent
  uint32_t* wanted;  // kKeyBits of the key that is looked for; 0: of nothing
};
constexpr uint8_t kWarpAbsent = 0, kWarpEdge = 1, kWarpPlain = 2;
struct WarpCounts {
  size_t plain, edges;
};

struct WarpKernels {
  // Positions of n pixels, any n >= 0. With r = 1 / w, x_64 = x * r rounded to nearest, halves to even, or kWarpNowhere
  // where that is not a number or does not fit (y_64 alike), and u_before = u * r, or 0 where that is not a number.
  // Where w <= 2^-60 or is not a number: kWarpNowhere in x_64 and y_64, 0 in u_before. Exactly n values of each array
  // are touched.
  void (*reproject_row)(const ReprojectionRow& row, const float* depth, size_t n, int32_t* x_64, int32_t* y_64,
                        float* u_before);

  // keys[i] = surface << 16 | code, where the surface is surfaces[id[i]], 0 beyond the table of n_surfaces >= 1, or
  // without a table (surfaces null) 1 for all ids but 0; and the code the upper 16 bits of u = min(max(1 - depth[i],
  // 0), 1.9921875) in float, which are below 2^14; of what is not a number 0. 0 where the surface is (modulo 2^16).
  void (*surface_keys_row)(const uint32_t* id, const float* depth, const uint32_t* surfaces, size_t n_surfaces,
                           size_t n, uint32_t* keys);

  // Looks n pixels up in the frame before: pixel i, which shows the surface of the key now[i], was where reproject_row
  // puts pixel first + i of that row, at 1 - depth u; wanted = that surface and the code of u. Absent where the nearest
  // pixel, floor((x_64 + 32) / 64), is outside the map; plain where the key at the floors of x_64 / 64 and y_64 / 64 is
  // smooth and differs from the wanted one by kKeyTolerance at most; else edge. Of surface 0, the background: absent,
  // kWarpNowhere, wanted 0. first + n < 2^24.
  WarpCounts (*find_points)(const ReprojectionRow& row, size_t first, const float* depth, const uint32_t* now,
                            const KeyMap& before, size_t n, const WarpPlaces& out);

  // The same for n samples at half the resolution, in a map of it: those that are wanted are full.wanted[2 i], and were
  // at half of full.x_64[2 i] and full.y_64[2 i], rounded down. Reads 2 n of each.
  WarpCounts (*find_half_points)(const WarpPlaces& full, const KeyMap& before, size_t n, const WarpPlaces& out);

  // Bit i of right (of word i / 64): here[i] and here[i + 1] do not belong together, they differ by more than
  // kKeyTolerance (the smooth bit is not set yet); bit i of down: nor do above[i] and here[i]. Bit n - 1 of right and
  // the last word's bits from n on are 0. Reads n + 1 keys of here.
  void (*compare_keys)(const uint32_t* above, const uint32_t* here, size_t n, uint64_t* right, uint64_t* down);

  // Sets kKeySmooth in those of n keys whose bits in `mixed` are 0.
  void (*mark_smooth)(const uint64_t* mixed, size_t n, uint32_t* keys);

  // n points of a plane of 16-bit samples in -8192..8191, rows `stride` apart; `plane` is its sample (0, 0). Those
  // whose state is kWarpAbsent are 0. Point i is at (x_64[i], y_64[i]), in 1/64: with the taps of the phases x_64 mod
  // 64 and y_64 mod 64, rows of `taps` [kWarpPhases][kWarpTapStride] whose sum is 512 and whose absolute sum is at most
  // 1020, and samples from column floor(x_64 / 64) - 2 and row floor(y_64 / 64) - 2 on
  //   v[j]   = (sum over k of taps[phase_y][k] * sample(j, k) + 128) >> 8     fits 16 bits
  //   out[i] = (sum over j of taps[phase_x][j] * v[j] + 512) >> 10            and so does this
  // limited to +-kLargestCarried.
  // Reads up to 16 samples of each of the 6 rows.
  void (*filter_points)(const int16_t* plane, ptrdiff_t stride, const int16_t* taps, const int32_t* x_64,
                        const int32_t* y_64, const uint8_t* state, size_t n, int16_t* out);

  // The same of two planes of one stride.
  void (*filter_both)(const int16_t* const planes[2], ptrdiff_t stride, const int16_t* taps, const int32_t* x_64,
                      const int32_t* y_64, const uint8_t* state, size_t n, int16_t* const out[2]);

  // Points whose state is kWarpEdge, found in `map` and in a plane as for filter_points: samples whose keys differ from
  // the wanted one by more than kKeyTolerance count as a stand-in. That is the mean of those of the four samples around
  // the point that do not, with their bilinear weights in 1/64, rounded to nearest, halves away from 0. out[i] = the
  // filter's result; 0 where all four differ (weigh nothing). Returns the number of these. Other points of out stay as
  // they are. Reads up to 8 samples and keys of each of the 6 rows.
  size_t (*filter_edges)(const int16_t* plane, ptrdiff_t stride, const KeyMap& map, const int16_t* taps,
                         const WarpPlaces& places, size_t n, int16_t* out);

  // The same with the stand-in itself in out[i], for two planes of one stride.
  size_t (*mean_edges)(const int16_t* const planes[2], ptrdiff_t stride, const KeyMap& map, const WarpPlaces& places,
                       size_t n, int16_t* const out[2]);

  // out[i] = min(max(base[i] + ((carried[i] + 16) >> 5), 0), 255), carried in -32700..32700. Any n and alignment.
  void (*add_carried_row)(const uint8_t* base, const int16_t* carried, size_t n, uint8_t* out);

  // n samples of a row of chroma at twice their resolution, 2 n of them, by weights 3/4 and 1/4 in each direction, from
  // carried differences of its nearer and its farther row, in +-255 * 2^kCarriedBits, to whole ones. With two bits kept
  // below the point, c[x] = 3 * ((near[x] + 4) >> 3) + ((far[x] + 4) >> 3),
  //   out[2 x] = (3 c[x] + c[x - 1] + 32) >> 6,  out[2 x + 1] = (3 c[x] + c[x + 1] + 32) >> 6     n >= 1
  // Reads samples -1..n + 31 of both rows; what lies behind sample n does not count.
  void (*upsample_carried_row)(const int16_t* near, const int16_t* far, size_t n, int16_t* out);

  // n pixels of a picture and of a difference, luma d = (carried + 16) >> 5 of carried ones in +-255 * 2^kCarriedBits,
  // chroma u and v in -255..255, to what is shown, interleaved:
  //   r = clamp(low_r + d + ((91881 v + 32768) >> 16)),  g = clamp(low_g + d + ((-22554 u - 46802 v + 32768) >> 16)),
  //   b = clamp(low_b + d + ((116130 u + 32768) >> 16))     to 0..255. Any n and alignment; rgb may be low.
  void (*composite_signed_row)(const uint8_t* low, const int16_t* carried, const int16_t* u, const int16_t* v, size_t n,
                               uint8_t* rgb);
};

// One per instruction set: overwrites the entries that it improves.
void fill_warp_scalar(WarpKernels& table);
void fill_warp_sse41(WarpKernels& table);
void fill_warp_avx2(WarpKernels& table);
void fill_warp_filters_avx2(WarpKernels& table);
void fill_warp_edges_avx2(WarpKernels& table);
void fill_warp_rows_avx2(WarpKernels& table);
void fill_warp_neon(WarpKernels& table);

}  // namespace pac
