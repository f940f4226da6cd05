// The motion kernels of every instruction set equal the scalar ones, and the transforms are accurate.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "tests/support/kernel_check.h"

namespace pac::test {
namespace {

constexpr size_t kStrides[] = {16, 17, 40};

TEST_CASE("distances: every instruction set gives the scalar number") {
  GuardedBuffer source(4096), reference(4096);
  for (uint64_t seed = 0; seed < 96; ++seed)
    for (const Pattern pattern : {Pattern::random, Pattern::extremes, Pattern::basis_signs, Pattern::ramp}) {
      const size_t stride = kStrides[seed % 3];
      const Guard guard = kGuards[seed % 2];
      uint8_t* s = source.place(15 * stride + 16, guard, seed % 16);
      uint8_t* r = reference.place(16 * stride + 17, guard, seed * 7 % 64);
      fill(std::span(s, 15 * stride + 16), pattern, 0, 255, seed);
      fill(std::span(r, 16 * stride + 17), seed % 4 == 0 ? Pattern::lowest : Pattern::random, 0, 255, seed + 1);
      const auto step = static_cast<ptrdiff_t>(stride);
      for_each_isa([&](const Kernels& scalar, const Kernels& table) {
        CHECK(table.motion.sad16(s, step, r, step) == scalar.motion.sad16(s, step, r, step));
        CHECK(table.motion.satd16(s, step, r, step) == scalar.motion.satd16(s, step, r, step));
        for (const int width : {8, 16})
          CHECK(table.motion.sse(s, step, r, step, width, width) == scalar.motion.sse(s, step, r, step, width, width));
        for (int kind = 0; kind < kHalfPelKinds; ++kind)
          CHECK(table.motion.sad16_half[kind](s, step, r, step) == scalar.motion.sad16_half[kind](s, step, r, step));
        const uint8_t* const four[4] = {r, r + 1, r + stride, r + stride + 1};
        uint32_t expected[4], actual[4];
        scalar.motion.sad16_x4(s, step, four, step, expected);
        table.motion.sad16_x4(s, step, four, step, actual);
        for (int i = 0; i < 4; ++i) CHECK(actual[i] == expected[i]);
        scalar.motion.sad16_quarters(s, step, r, step, expected);
        table.motion.sad16_quarters(s, step, r, step, actual);
        for (int i = 0; i < 4; ++i) CHECK(actual[i] == expected[i]);
        CHECK(actual[0] + actual[1] + actual[2] + actual[3] == scalar.motion.sad16(s, step, r, step));
        CHECK(table.motion.sad8(s, step, r, step) == expected[0]);
        uint32_t sums[4];
        scalar.motion.moments16(s, step, &sums[0], &sums[1]);
        table.motion.moments16(s, step, &sums[2], &sums[3]);
        CHECK(sums[0] == sums[2]);
        CHECK(sums[1] == sums[3]);
      });
    }
}

TEST_CASE("means of squares: every instruction set gives the scalar bits and reads no further") {
  KernelCheck check(4096);
  for (uint64_t seed = 0; seed < 120; ++seed) {
    const size_t n = 4 * (1 + seed % 11), stride = 4 * n + seed % 3 * 5;
    const Guard guard = kGuards[seed / 2 % 2];
    const Pattern pattern = seed % 5 == 0 ? Pattern::extremes : Pattern::random;
    const uint8_t* samples = check.input<uint8_t>(0, 3 * stride + 4 * n, guard, seed % 64, pattern, 0, 255, seed);
    check.compare<uint8_t>(n, guard, seed * 3 % 64, [&](const Kernels& table, uint8_t* out) {
      table.motion.means_4x4(samples, static_cast<ptrdiff_t>(stride), static_cast<int>(n), out);
    });
  }
}

TEST_CASE("distances across: those of sad8, on every instruction set") {
  GuardedBuffer source(4096), reference(4096);
  for (uint64_t seed = 0; seed < 120; ++seed) {
    const size_t n = 1 + seed % 19, width = 8 * ((n + 3) / 4) + 8, stride = width + seed % 3 * 5;
    const Guard guard = kGuards[seed / 2 % 2];
    uint8_t* const s = source.place(7 * stride + 8, guard, seed % 16);
    uint8_t* const r = reference.place(7 * stride + width, guard, seed * 7 % 64);
    fill(std::span(s, 7 * stride + 8), seed % 5 == 0 ? Pattern::extremes : Pattern::random, 0, 255, seed);
    fill(std::span(r, 7 * stride + width), seed % 4 == 0 ? Pattern::lowest : Pattern::random, 0, 255, seed + 1);
    const auto step = static_cast<ptrdiff_t>(stride);
    for_each_isa([&](const Kernels& scalar, const Kernels& table) {
      uint32_t sads[20];
      table.motion.sad8_across(s, step, r, step, static_cast<int>(n), sads);
      for (size_t k = 0; k < n; ++k) CHECK(sads[k] == scalar.motion.sad8(s, step, r + 2 * k, step));
    });
  }
}

TEST_CASE("predictions: every instruction set gives the scalar bits and reads no further than they say") {
  KernelCheck check(4096);
  for (uint64_t seed = 0; seed < 60; ++seed)
    for (int kind = 0; kind < kHalfPelKinds; ++kind)
      for (const size_t width : {size_t{8}, size_t{16}}) {
        const size_t stride = width + 1 + seed % 3 * 9, height = seed % 2 == 0 ? width : 4;
        const size_t bytes =
            (height - 1 + static_cast<size_t>(kind / 2)) * stride + width + static_cast<size_t>(kind % 2);
        const Guard guard = kGuards[seed / 2 % 2];
        const Pattern pattern = seed % 5 == 0 ? Pattern::extremes : Pattern::random;
        const uint8_t* r = check.input<uint8_t>(0, bytes, guard, seed % 64, pattern, 0, 255, seed);
        const uint8_t* other = check.input<uint8_t>(1, bytes, guard, seed % 64, pattern, 0, 255, seed + 7);
        const auto step = static_cast<ptrdiff_t>(stride);
        const auto out_step = static_cast<ptrdiff_t>(width);
        check.compare<uint8_t>(width * height, guard, seed * 3 % 64, [&](const Kernels& table, uint8_t* out) {
          if (width == 16) return table.motion.predict16[kind](r, step, out, out_step, static_cast<int>(height));
          if (height == 4) return;  // of 8 samples width there are blocks of 8x8 only
          const uint8_t* const references[2] = {other, r};
          uint8_t unchecked[64];
          uint8_t* const predictions[2] = {seed % 3 == 0 ? out : unchecked, seed % 3 == 0 ? unchecked : out};
          table.motion.predict8_pair[kind](references, step, predictions, out_step);
        });
        if (kind != 0) continue;
        check.compare<uint8_t>(width * height, guard, seed * 3 % 64, [&](const Kernels& table, uint8_t* out) {
          table.motion.average(out, out_step, r, step, static_cast<int>(width), static_cast<int>(height));
        });
      }
}

TEST_CASE("fdct_macroblock: every instruction set gives the scalar bits and the blocks that reach a threshold") {
  KernelCheck check(8192);
  for (const Pattern pattern : kPatterns)
    for (uint64_t seed = 0; seed < 64; ++seed) {
      CAPTURE(pattern_name(pattern));
      // Y, Cb and Cr one after the other, each with a stride of its own.
      const size_t strides[3] = {16 + seed % 2, 8 + seed % 3, 8 + seed % 5};
      const size_t sizes[3] = {15 * strides[0] + 16, 7 * strides[1] + 8, 7 * strides[2] + 8};
      const size_t total = sizes[0] + sizes[1] + sizes[2];
      const uint8_t* s = check.input<uint8_t>(0, total, Guard::after, seed % 64, pattern, 0, 255, seed);
      const Pattern other = seed % 3 == 0 ? Pattern::zeros : seed % 3 == 1 ? Pattern::random : Pattern::highest;
      const uint8_t* p = check.input<uint8_t>(1, total, Guard::after, 0, other, 0, 255, seed + 9);
      PredictedSamples samples;
      for (size_t plane = 0, at = 0; plane < 3; at += sizes[plane++]) {
        samples.source[plane] = s + at;
        samples.prediction[plane] = p + at;
        samples.source_stride[plane] = samples.prediction_stride[plane] = static_cast<ptrdiff_t>(strides[plane]);
      }
      for (const int threshold : {1, 48, 600, 16384})
        check.compare<int16_t>(64 * 6, Guard::after, seed * 2 % 64, [&](const Kernels& table, int16_t* out) {
          const uint32_t reaching = table.motion.fdct_macroblock(samples, threshold, out);
          for (size_t block = 0; block < 6; ++block) {
            const auto reaches = [&](int16_t c) { return std::abs(c) >= threshold; };
            CHECK((reaching >> block & 1) == (std::any_of(out + 64 * block, out + 64 * block + 64, reaches) ? 1 : 0));
          }
        });
    }
}

TEST_CASE("fdct_reaching: what it finds and stores is fdct_macroblock's, at any threshold around the energy") {
  for (int isa = 0; isa < kIsaCount; ++isa) {
    const Kernels* table = kernels_for(static_cast<Isa>(isa));
    if (table == nullptr) continue;
    uint64_t state = 7;
    bool found_all = true, stored_all = true;
    for (int round = 0; round < 4000; ++round) {
      // Basis functions, whose energy is all in one coefficient, and noise.
      uint8_t source[384], prediction[384];
      const int u = round & 7, v = round >> 3 & 7, amplitude = 1 + round / 64 % 40;
      for (size_t i = 0; i < 384; ++i) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const size_t x = i < 256 ? i % 16 : i % 8, y = i < 256 ? i / 16 : i % 64 / 8;
        const double wave = std::cos(static_cast<double>(2 * (x & 7) + 1) * u * 3.14159265358979 / 16) *
                            std::cos(static_cast<double>(2 * (y & 7) + 1) * v * 3.14159265358979 / 16);
        const int noise = static_cast<int>(state >> 33) % (2 * amplitude + 1) - amplitude;
        prediction[i] = 128;
        const bool is_noise = round % 3 == 0;
        source[i] = static_cast<uint8_t>(128 + (is_noise ? noise : static_cast<int>(std::lround(amplitude * wave))));
      }
      PredictedSamples samples;
      for (size_t plane = 0; plane < 3; ++plane) {
        const size_t at = plane == 0 ? 0 : 192 + 64 * plane;
        samples.source[plane] = source + at, samples.prediction[plane] = prediction + at;
        samples.source_stride[plane] = samples.prediction_stride[plane] = plane == 0 ? 16 : 8;
      }
      alignas(64) int16_t all[384], some[384];
      table->motion.fdct_macroblock(samples, 1, all);
      int largest = 0;
      for (const int16_t c : all) largest = std::max(largest, std::abs(int{c}));
      for (const int threshold : {1, 3, 5, std::max(1, largest - 1), std::max(1, largest), largest + 1, largest + 9}) {
        const uint32_t reaching = table->motion.fdct_macroblock(samples, threshold, all);
        found_all &= table->motion.fdct_reaching(samples, threshold, some) == reaching;
        for (int pair = 0; pair < 3; ++pair)
          if ((reaching >> 2 * pair & 3) != 0)
            stored_all &= std::equal(all + 128 * pair, all + 128 * pair + 128, some + 128 * pair);
      }
    }
    CHECK(found_all);
    CHECK(stored_all);
  }
}

TEST_CASE("idct: every instruction set gives the scalar bits, whatever the input") {
  KernelCheck check(8192);
  for (const int64_t range : {300, 2047, 32767})
    for (const Pattern pattern : kPatterns)
      for (uint64_t seed = 0; seed < 64; ++seed) {
        const size_t n = 1 + seed % 5;
        const int16_t* coefficients =
            check.input<int16_t>(0, 64 * n, Guard::after, seed * 2 % 64, pattern, -range - 1, range, seed);
        const auto run = [&](auto member) {
          check.compare<uint8_t>(64 * n, Guard::after, seed % 64, [&](const Kernels& table, uint8_t* out) {
            uint8_t* samples[5];
            ptrdiff_t strides[5];
            for (size_t i = 0; i < n; ++i) samples[i] = out + 64 * i, strides[i] = 8;
            (table.motion.*member)(coefficients, n, samples, strides);
          });
        };
        run(&MotionKernels::idct_add);
        run(&MotionKernels::idct_put);
      }
}

TEST_CASE("idct_dc_add is idct_add of a lone DC coefficient") {
  for (int dc = -2048; dc <= 2047; ++dc)
    for (const Kernels* table : {kernels_for(Isa::scalar), &kernels()}) {
      std::array<uint8_t, 64> one, other;
      for (size_t i = 0; i < 64; ++i) one[i] = other[i] = static_cast<uint8_t>(i * 4);
      int16_t coefficients[64] = {static_cast<int16_t>(dc)};
      uint8_t* samples = one.data();
      const ptrdiff_t stride = 8;
      table->motion.idct_add(coefficients, 1, &samples, &stride);
      table->motion.idct_dc_add(dc, other.data(), 8);
      REQUIRE(one == other);
    }
}

// IEEE 1180-1990 section 3: blocks of random errors through an exact forward transform, rounded to coefficients,
// back by the exact inverse and by ours.
struct Accuracy {
  double peak = 0, worst_mse = 0, mse = 0, worst_mean = 0, mean = 0;
};

using Matrix = std::array<double, 64>;
Matrix basis() {
  Matrix c;
  for (size_t u = 0; u < 8; ++u)
    for (size_t x = 0; x < 8; ++x)
      c[8 * u + x] = (u == 0 ? std::sqrt(0.125) : 0.5) *
                     std::cos(static_cast<double>((2 * x + 1) * u) * 3.14159265358979323846 / 16);
  return c;
}
// c * in * c^T, or its inverse.
Matrix transform(const Matrix& c, const Matrix& in, bool inverse) {
  const auto at = [&](size_t i, size_t j) { return inverse ? c[8 * j + i] : c[8 * i + j]; };
  Matrix half{}, out{};
  for (size_t i = 0; i < 8; ++i)
    for (size_t j = 0; j < 8; ++j)
      for (size_t k = 0; k < 8; ++k) half[8 * i + j] += at(i, k) * in[8 * k + j];
  for (size_t i = 0; i < 8; ++i)
    for (size_t j = 0; j < 8; ++j)
      for (size_t k = 0; k < 8; ++k) out[8 * i + j] += half[8 * i + k] * at(j, k);
  return out;
}

// The error block that the kernel computes, through samples of 128 so that nothing of -128..127 is clamped; larger
// errors are compared as far as they are seen.
Accuracy measure_accuracy(int low, int high, int sign, int n_blocks) {
  const Matrix c = basis();
  Random random(static_cast<uint64_t>(high * 2 + sign));
  std::array<double, 64> sum{}, squares{};
  Accuracy accuracy;
  for (int block = 0; block < n_blocks; ++block) {
    Matrix samples;
    for (double& s : samples) s = static_cast<double>(sign * random.in(-low, high));
    const Matrix dct = transform(c, samples, false);
    int16_t coefficients[64];
    Matrix rounded;
    for (size_t i = 0; i < 64; ++i) {
      rounded[i] = std::min(2047.0, std::max(-2048.0, std::floor(dct[i] + 0.5)));
      coefficients[i] = static_cast<int16_t>(rounded[i]);
    }
    const Matrix exact = transform(c, rounded, true);
    uint8_t up[64] = {}, down[64];
    std::memset(down, 255, sizeof down);
    uint8_t* planes[2] = {up, down};
    const ptrdiff_t strides[2] = {8, 8};
    kernels().motion.idct_add(coefficients, 1, planes, strides);
    kernels().motion.idct_add(coefficients, 1, planes + 1, strides);
    for (size_t i = 0; i < 64; ++i) {
      const int ours = up[i] != 0 ? up[i] : down[i] - 255;  // positive errors from 0 up, negative from 255 down
      const double reference = std::min(255.0, std::max(-255.0, std::floor(exact[i] + 0.5)));
      const double error = ours - reference;
      accuracy.peak = std::max(accuracy.peak, std::abs(error));
      sum[i] += error;
      squares[i] += error * error;
    }
  }
  for (size_t i = 0; i < 64; ++i) {
    accuracy.worst_mse = std::max(accuracy.worst_mse, squares[i] / n_blocks);
    accuracy.worst_mean = std::max(accuracy.worst_mean, std::abs(sum[i]) / n_blocks);
    accuracy.mse += squares[i] / n_blocks / 64;
    accuracy.mean += sum[i] / n_blocks / 64;
  }
  return accuracy;
}

TEST_CASE("idct meets the limits of IEEE 1180-1990") {
  for (const auto& [low, high] : {std::pair{256, 255}, {5, 5}, {300, 300}})
    for (const int sign : {1, -1}) {
      const Accuracy accuracy = measure_accuracy(low, high, sign, 10000);
      CHECK(accuracy.peak <= 1);
      CHECK(accuracy.worst_mse <= 0.06);
      CHECK(accuracy.mse <= 0.02);
      CHECK(accuracy.worst_mean <= 0.015);
      CHECK(std::abs(accuracy.mean) <= 0.0015);
    }
}

}  // namespace
}  // namespace pac::test
