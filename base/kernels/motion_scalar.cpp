#include <cstddef>
#include <cstdint>

#include "base/kernels/motion_kernels.h"

namespace pac {
namespace {

int clamp(int value, int low, int high) {
  return value < low ? low : value > high ? high : value;
}
int saturate16(int value) {
  return clamp(value, -32768, 32767);
}
int round_shift(int value, int shift) {
  return (value + (1 << (shift - 1))) >> shift;
}
int magnitude(int value) {
  return value < 0 ? -value : value;
}

// ---- Prediction ----------------------------------------------------------------------------------------------------

template <int kKind>
int half_pel(const uint8_t* p, ptrdiff_t stride) {
  if constexpr (kKind == 0) return p[0];
  if constexpr (kKind == 1) return (p[0] + p[1] + 1) >> 1;
  if constexpr (kKind == 2) return (p[0] + p[stride] + 1) >> 1;
  return (p[0] + p[1] + p[stride] + p[stride + 1] + 2) >> 2;
}

template <int kWidth, int kKind>
void predict(const uint8_t* reference, ptrdiff_t reference_stride, uint8_t* prediction, ptrdiff_t prediction_stride,
             int height) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < kWidth; ++x)
      prediction[y * prediction_stride + x] =
          static_cast<uint8_t>(half_pel<kKind>(reference + y * reference_stride + x, reference_stride));
}
template <int kKind>
void predict16(const uint8_t* reference, ptrdiff_t reference_stride, uint8_t* prediction, ptrdiff_t prediction_stride,
               int height) {
  predict<16, kKind>(reference, reference_stride, prediction, prediction_stride, height);
}
template <int kKind>
void predict8_pair(const uint8_t* const references[2], ptrdiff_t reference_stride, uint8_t* const predictions[2],
                   ptrdiff_t prediction_stride) {
  for (int i = 0; i < 2; ++i) predict<8, kKind>(references[i], reference_stride, predictions[i], prediction_stride, 8);
}

void average(uint8_t* prediction, ptrdiff_t prediction_stride, const uint8_t* other, ptrdiff_t other_stride, int width,
             int height) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      uint8_t& p = prediction[y * prediction_stride + x];
      p = static_cast<uint8_t>((p + other[y * other_stride + x] + 1) >> 1);
    }
}

// ---- Distances -----------------------------------------------------------------------------------------------------

template <int kKind>
uint32_t sad16_half(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                    ptrdiff_t reference_stride) {
  uint32_t sum = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      sum += static_cast<uint32_t>(magnitude(source[y * source_stride + x] -
                                             half_pel<kKind>(reference + y * reference_stride + x, reference_stride)));
  return sum;
}

void sad16_x4(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* const* references,
              ptrdiff_t reference_stride, uint32_t* sads) {
  for (int i = 0; i < 4; ++i) sads[i] = sad16_half<0>(source, source_stride, references[i], reference_stride);
}

uint32_t sad8(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference, ptrdiff_t reference_stride) {
  uint32_t sum = 0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      sum += static_cast<uint32_t>(magnitude(source[y * source_stride + x] - reference[y * reference_stride + x]));
  return sum;
}

void sad8_across(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference, ptrdiff_t reference_stride,
                 int n, uint32_t* sads) {
  for (int k = 0; k < n; ++k) sads[k] = sad8(source, source_stride, reference + 2 * k, reference_stride);
}

void sad16_quarters(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* reference,
                    ptrdiff_t reference_stride, uint32_t* sads) {
  for (int i = 0; i < 4; ++i)
    sads[i] = sad8(source + (i >> 1) * 8 * source_stride + (i & 1) * 8, source_stride,
                   reference + (i >> 1) * 8 * reference_stride + (i & 1) * 8, reference_stride);
}

void hadamard_1d(int* x, int step) {
  for (int half = 1; half < 8; half *= 2)
    for (int i = 0; i < 8; i += 2 * half)
      for (int j = i; j < i + half; ++j) {
        const int a = x[j * step], b = x[(j + half) * step];
        x[j * step] = a + b;
        x[(j + half) * step] = a - b;
      }
}

uint32_t satd8(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* prediction, ptrdiff_t prediction_stride) {
  int work[64];
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) work[8 * y + x] = source[y * source_stride + x] - prediction[y * prediction_stride + x];
  for (int i = 0; i < 8; ++i) hadamard_1d(work + 8 * i, 1);
  for (int i = 0; i < 8; ++i) hadamard_1d(work + i, 8);
  uint32_t sum = 0;
  for (const int v : work) sum += static_cast<uint32_t>(magnitude(v));
  return (sum + 2) >> 2;
}

uint32_t satd16(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* prediction,
                ptrdiff_t prediction_stride) {
  uint32_t sum = 0;
  for (int y = 0; y < 16; y += 8)
    for (int x = 0; x < 16; x += 8)
      sum += satd8(source + y * source_stride + x, source_stride, prediction + y * prediction_stride + x,
                   prediction_stride);
  return sum;
}

uint32_t sse(const uint8_t* a, ptrdiff_t a_stride, const uint8_t* b, ptrdiff_t b_stride, int width, int height) {
  uint32_t sum = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int difference = a[y * a_stride + x] - b[y * b_stride + x];
      sum += static_cast<uint32_t>(difference * difference);
    }
  return sum;
}

void means_4x4(const uint8_t* samples, ptrdiff_t stride, int n, uint8_t* means) {
  for (int i = 0; i < n; ++i) {
    int sum = 0;
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) sum += samples[y * stride + 4 * i + x];
    means[i] = static_cast<uint8_t>((sum + 8) >> 4);
  }
}

void moments16(const uint8_t* source, ptrdiff_t stride, uint32_t* sum, uint32_t* sum_of_squares) {
  *sum = *sum_of_squares = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const uint32_t sample = source[y * stride + x];
      *sum += sample;
      *sum_of_squares += sample * sample;
    }
}

// ---- Transforms ----------------------------------------------------------------------------------------------------

// round(c * 2^13); ck = cos(k*pi/16). The rotations of the LLM flow graph, multiplied out.
constexpr int kConstBits = 13;
constexpr int k0_541 = 4433;   // sqrt(2) * c6
constexpr int k0_765 = 6270;   // sqrt(2) * (c2 - c6)
constexpr int k1_847 = 15137;  // sqrt(2) * (c2 + c6)
constexpr int k1_175 = 9633;   // sqrt(2) * c3
constexpr int k1_961 = 16069;  // sqrt(2) * (c3 + c5)
constexpr int k0_390 = 3196;   // sqrt(2) * (c3 - c5)
constexpr int k0_298 = 2446;   // sqrt(2) * (-c1 + c3 + c5 - c7)
constexpr int k2_053 = 16819;  // sqrt(2) * ( c1 + c3 - c5 + c7)
constexpr int k3_072 = 25172;  // sqrt(2) * ( c1 + c3 + c5 - c7)
constexpr int k1_501 = 12299;  // sqrt(2) * ( c1 + c3 - c5 - c7)
constexpr int k0_899 = 7373;   // sqrt(2) * (c3 - c7)
constexpr int k2_562 = 20995;  // sqrt(2) * (c1 + c3)

constexpr int kForwardPassBits = 1;  // of fraction between the passes: 255 * 8 * 2 * 8 = 32640 fits 16 bits
constexpr int kInversePassBits = 3;  // 255 * 64 = 16320: twice the range of legal errors stays unsaturated

// One dimension, forward: x[0..7] become sqrt(8) * 2^(13 - shift) times the DCT.
void fdct_1d(int (&x)[8], int shift) {
  const int sum07 = x[0] + x[7], difference07 = x[0] - x[7], sum16 = x[1] + x[6], difference16 = x[1] - x[6];
  const int sum25 = x[2] + x[5], difference25 = x[2] - x[5], sum34 = x[3] + x[4], difference34 = x[3] - x[4];

  const int even0 = sum07 + sum34, even3 = sum07 - sum34, even1 = sum16 + sum25, even2 = sum16 - sum25;
  const int dc = even0 + even1, c4 = even0 - even1;
  x[0] = shift < kConstBits ? dc * (1 << (kConstBits - shift)) : round_shift(dc, shift - kConstBits);
  x[4] = shift < kConstBits ? c4 * (1 << (kConstBits - shift)) : round_shift(c4, shift - kConstBits);
  x[2] = round_shift(even2 * k0_541 + even3 * (k0_541 + k0_765), shift);
  x[6] = round_shift(even2 * (k0_541 - k1_847) + even3 * k0_541, shift);

  const int z3 = difference34 + difference16, z4 = difference25 + difference07;
  const int odd3 = z3 * (k1_175 - k1_961) + z4 * k1_175, odd4 = z3 * k1_175 + z4 * (k1_175 - k0_390);
  x[7] = round_shift(difference34 * (k0_298 - k0_899) - difference07 * k0_899 + odd3, shift);
  x[1] = round_shift(difference07 * (k1_501 - k0_899) - difference34 * k0_899 + odd4, shift);
  x[5] = round_shift(difference25 * (k2_053 - k2_562) - difference16 * k2_562 + odd4, shift);
  x[3] = round_shift(difference16 * (k3_072 - k2_562) - difference25 * k2_562 + odd3, shift);
}

void fdct_block(const uint8_t* source, ptrdiff_t source_stride, const uint8_t* prediction, ptrdiff_t prediction_stride,
                int16_t* coefficients) {
  int work[64];
  for (int row = 0; row < 8; ++row) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = source[row * source_stride + i] - prediction[row * prediction_stride + i];
    fdct_1d(x, kConstBits - kForwardPassBits);
    for (int i = 0; i < 8; ++i) work[8 * row + i] = x[i];
  }
  for (int column = 0; column < 8; ++column) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = work[8 * i + column];
    fdct_1d(x, kConstBits + kForwardPassBits);
    for (int i = 0; i < 8; ++i) coefficients[8 * i + column] = static_cast<int16_t>(x[i]);
  }
}

uint32_t fdct_macroblock(const PredictedSamples& samples, int threshold, int16_t* coefficients) {
  uint32_t reaching = 0;
  for (int block = 0; block < 6; ++block, coefficients += 64) {
    const int plane = block < 4 ? 0 : block - 3;
    const ptrdiff_t x = block < 4 ? block % 2 * 8 : 0, y = block < 4 ? block / 2 * 8 : 0;
    const ptrdiff_t source_stride = samples.source_stride[plane], prediction_stride = samples.prediction_stride[plane];
    fdct_block(samples.source[plane] + y * source_stride + x, source_stride,
               samples.prediction[plane] + y * prediction_stride + x, prediction_stride, coefficients);
    for (int i = 0; i < 64; ++i)
      if (magnitude(coefficients[i]) >= threshold) reaching |= uint32_t{1} << block;
  }
  return reaching;
}

// One dimension, inverse, not yet rounded: 2^13 * sqrt(8) times the samples.
void idct_1d(int (&x)[8]) {
  const int even2 = x[2] * (k0_541 + k0_765) + x[6] * k0_541;
  const int even3 = x[2] * k0_541 + x[6] * (k0_541 - k1_847);
  const int even0 = saturate16(x[0] + x[4]) * (1 << kConstBits), even1 = saturate16(x[0] - x[4]) * (1 << kConstBits);
  const int a0 = even0 + even2, a3 = even0 - even2, a1 = even1 + even3, a2 = even1 - even3;

  const int z3 = saturate16(x[7] + x[3]), z4 = saturate16(x[5] + x[1]);
  const int odd3 = z3 * (k1_175 - k1_961) + z4 * k1_175, odd4 = z3 * k1_175 + z4 * (k1_175 - k0_390);
  const int b0 = x[7] * (k0_298 - k0_899) - x[1] * k0_899 + odd3;
  const int b1 = x[5] * (k2_053 - k2_562) - x[3] * k2_562 + odd4;
  const int b2 = x[3] * (k3_072 - k2_562) - x[5] * k2_562 + odd3;
  const int b3 = x[1] * (k1_501 - k0_899) - x[7] * k0_899 + odd4;
  x[0] = a0 + b3, x[7] = a0 - b3, x[1] = a1 + b2, x[6] = a1 - b2;
  x[2] = a2 + b1, x[5] = a2 - b1, x[3] = a3 + b0, x[4] = a3 - b0;
}

void idct_block(const int16_t* coefficients, int (&errors)[64]) {
  int work[64];
  for (int column = 0; column < 8; ++column) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = coefficients[8 * i + column];
    idct_1d(x);
    for (int i = 0; i < 8; ++i) work[8 * i + column] = saturate16(round_shift(x[i], kConstBits - kInversePassBits));
  }
  for (int row = 0; row < 8; ++row) {
    int x[8];
    for (int i = 0; i < 8; ++i) x[i] = work[8 * row + i];
    idct_1d(x);
    for (int i = 0; i < 8; ++i) errors[8 * row + i] = saturate16(round_shift(x[i], kConstBits + kInversePassBits + 3));
  }
}

template <bool kAdd>
void idct(const int16_t* coefficients, size_t n_blocks, uint8_t* const* samples, const ptrdiff_t* strides) {
  for (size_t block = 0; block < n_blocks; ++block) {
    int errors[64];
    idct_block(coefficients + 64 * block, errors);
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) {
        uint8_t& sample = samples[block][y * strides[block] + x];
        sample = static_cast<uint8_t>(clamp((kAdd ? sample : 0) + errors[8 * y + x], 0, 255));
      }
  }
}

void idct_dc_add(int dc, uint8_t* samples, ptrdiff_t stride) {
  const int error = (dc + 4) >> 3;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      uint8_t& sample = samples[y * stride + x];
      sample = static_cast<uint8_t>(clamp(sample + error, 0, 255));
    }
}

}  // namespace

void fill_motion_scalar(MotionKernels& table) {
  table.sad16 = sad16_half<0>;
  table.sad16_x4 = sad16_x4;
  table.sad16_quarters = sad16_quarters;
  table.sad8 = sad8;
  table.sad16_half[0] = sad16_half<0>, table.sad16_half[1] = sad16_half<1>;
  table.sad16_half[2] = sad16_half<2>, table.sad16_half[3] = sad16_half<3>;
  table.satd16 = satd16;
  table.sse = sse;
  table.moments16 = moments16;
  table.sad8_across = sad8_across;
  table.means_4x4 = means_4x4;
  table.predict16[0] = predict16<0>, table.predict16[1] = predict16<1>;
  table.predict16[2] = predict16<2>, table.predict16[3] = predict16<3>;
  table.predict8_pair[0] = predict8_pair<0>, table.predict8_pair[1] = predict8_pair<1>;
  table.predict8_pair[2] = predict8_pair<2>, table.predict8_pair[3] = predict8_pair<3>;
  table.average = average;
  table.fdct_macroblock = fdct_macroblock;
  table.fdct_reaching = fdct_macroblock;
  table.idct_add = idct<true>;
  table.idct_put = idct<false>;
  table.idct_dc_add = idct_dc_add;
}

}  // namespace pac
