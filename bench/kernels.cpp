// Every kernel on every instruction set that this machine runs. Names are kernel/isa/where the data lies.
//   build/release/bench/pac_bench --benchmark_filter='fdct8x8|idct8x8'
#include "base/kernels/kernels.h"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/image.h"

namespace {

using namespace pac;

// Sizes of input and output together: inside L1, inside L2, far outside any cache.
struct Place {
  const char* name;
  size_t bytes;
};
constexpr Place kPlaces[] = {{"L1", 16 << 10}, {"L2", 256 << 10}, {"DRAM", 128 << 20}};

// A little structure, a little noise: branches and zeros as in pictures.
AlignedBytes make_bytes(size_t n, uint32_t seed) {
  AlignedBytes bytes(n);
  uint32_t state = seed;
  for (size_t i = 0; i < n; ++i) {
    state = state * 1664525 + 1013904223;
    bytes.data()[i] = static_cast<uint8_t>((i / 3 & 127) + (state >> 27));
  }
  return bytes;
}

template <class Fn>
void register_for_each(const char* kernel, Fn fn) {
  for (int i = 0; i < kIsaCount; ++i) {
    const Kernels* table = kernels_for(static_cast<Isa>(i));
    if (table == nullptr) continue;
    for (const Place& place : kPlaces) {
      const std::string name = std::string(kernel) + "/" + isa_name(table->isa) + "/" + place.name;
      benchmark::RegisterBenchmark(name.c_str(),
                                   [table, place, fn](benchmark::State& state) { fn(state, *table, place.bytes); });
    }
  }
}

// A row kernel with up to three inputs and three outputs of n samples times a factor each.
struct RowShape {
  size_t in[3], out[3];
  size_t bytes_per_unit() const { return in[0] + in[1] + in[2] + out[0] + out[1] + out[2]; }
};

// call(table, in, out, n); counts pixels (units) a second and bytes of input and output a second. Long buffers are
// walked in rows of 1920, as pictures are.
template <class Call>
void register_row(const char* kernel, RowShape shape, Call call) {
  register_for_each(kernel, [shape, call](benchmark::State& state, const Kernels& table, size_t bytes) {
    const size_t n_units = bytes / shape.bytes_per_unit();
    std::vector<AlignedBytes> buffers;
    for (size_t i = 0; i < 3; ++i) buffers.push_back(make_bytes(n_units * shape.in[i], static_cast<uint32_t>(i)));
    for (size_t i = 0; i < 3; ++i) buffers.push_back(make_bytes(n_units * shape.out[i], 9));
    for (auto _ : state) {
      for (size_t at = 0; at < n_units; at += 1920) {
        const uint8_t* in[3];
        uint8_t* out[3];
        for (size_t i = 0; i < 3; ++i) in[i] = buffers[i].data() + at * shape.in[i];
        for (size_t i = 0; i < 3; ++i) out[i] = buffers[3 + i].data() + at * shape.out[i];
        call(table.pixel, in, out, n_units - at < 1920 ? n_units - at : 1920);
      }
      benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(static_cast<int64_t>(n_units) * state.iterations());
    state.SetBytesProcessed(static_cast<int64_t>(n_units * shape.bytes_per_unit()) * state.iterations());
  });
}

void register_pixel_kernels() {
  using Table = const PixelKernels&;
  using In = const uint8_t* const*;
  using Out = uint8_t* const*;
  register_row("difference_row", {{1, 1, 0}, {1, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.difference_row(in[0], in[1], out[0], n); });
  register_row("composite_row", {{1, 1, 0}, {1, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.composite_row(in[0], in[1], out[0], n); });
  register_row("ycc_from_rgb_row", {{3, 0, 0}, {1, 1, 1}},
               [](Table t, In in, Out out, size_t n) { t.ycc_from_rgb_row(in[0], n, out[0], out[1], out[2]); });
  register_row("ycc420_from_rgb_rows", {{3, 3, 0}, {1, 1, 1}}, [](Table t, In in, Out out, size_t n) {
    t.ycc420_from_rgb_rows(in[0], in[1], n, out[0], out[1], out[2], out[2] + n / 2);
  });
  register_row("rgb_from_ycc_row", {{1, 1, 1}, {3, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.rgb_from_ycc_row(in[0], in[1], in[2], n, out[0]); });
  register_row("downsample_h2v1_row", {{2, 0, 0}, {1, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.downsample_h2v1_row(in[0], n, out[0]); });
  register_row("downsample_h2v2_row", {{2, 2, 0}, {1, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.downsample_h2v2_row(in[0], in[1], n, out[0]); });
  register_row("upsample_h2v1_row", {{1, 0, 0}, {2, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.upsample_h2v1_row(in[0], n, out[0]); });
  register_row("upsample_h2v2_row", {{1, 1, 0}, {2, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.upsample_h2v2_row(in[0], in[1], n, out[0]); });
  register_row("upsample_h1v2_row", {{1, 1, 0}, {1, 0, 0}},
               [](Table t, In in, Out out, size_t n) { t.upsample_h1v2_row(in[0], in[1], 1, n, out[0]); });
}

// Rows of 240 blocks (1920 samples); items are blocks.
constexpr size_t kRowBlocks = 240;

void count_blocks(benchmark::State& state, size_t n_blocks, size_t bytes_per_block) {
  state.SetItemsProcessed(static_cast<int64_t>(n_blocks) * state.iterations());
  state.SetBytesProcessed(static_cast<int64_t>(n_blocks * bytes_per_block) * state.iterations());
}

template <class Call>
void for_each_row_of_blocks(size_t n_blocks, Call call) {
  for (size_t at = 0; at < n_blocks; at += kRowBlocks)
    call(at, n_blocks - at < kRowBlocks ? n_blocks - at : kRowBlocks);
}

void bench_fdct(benchmark::State& state, const Kernels& table, size_t bytes) {
  const size_t n_blocks = bytes / 192;
  const AlignedBytes samples = make_bytes(64 * n_blocks, 1);
  std::vector<int16_t> coefficients(64 * n_blocks);
  for (auto _ : state) {
    for_each_row_of_blocks(n_blocks, [&](size_t at, size_t n) {
      table.block.fdct_islow(samples.data() + 64 * at, static_cast<ptrdiff_t>(8 * n), n, &coefficients[64 * at]);
    });
    benchmark::ClobberMemory();
  }
  count_blocks(state, n_blocks, 192);
}

// Blocks to 4x4 or 2x2 samples.
template <int kSide>
void bench_reduced_idct(benchmark::State& state, const Kernels& table, size_t bytes) {
  const size_t n_blocks = bytes / 192;
  std::vector<int16_t> levels(64 * n_blocks);
  for (size_t i = 0; i < levels.size(); ++i) levels[i] = static_cast<int16_t>(i * 7 % 13 - 6);
  const std::vector<uint16_t> steps(64, 17);
  AlignedBytes samples(64 * n_blocks);
  const auto kernel = kSide == 4 ? table.block.idct_4x4 : table.block.idct_2x2;
  for (auto _ : state) {
    for_each_row_of_blocks(n_blocks, [&](size_t at, size_t n) {
      kernel(&levels[64 * at], steps.data(), n, samples.data() + 64 * at, static_cast<ptrdiff_t>(kSide * n));
    });
    benchmark::ClobberMemory();
  }
  count_blocks(state, n_blocks, 192);
}

// kLast: zigzag position of the last level of each block.
template <uint8_t kLast>
void bench_idct(benchmark::State& state, const Kernels& table, size_t bytes) {
  const size_t n_blocks = bytes / 192;
  std::vector<int16_t> levels(64 * n_blocks);
  for (size_t i = 0; i < n_blocks; ++i)
    for (size_t k = 0; k <= kLast; ++k)
      levels[64 * i + kNaturalFromZigzag[k]] = static_cast<int16_t>((i * 7 + k * 5) % 13 - 6);
  const std::vector<uint16_t> steps(64, 17);
  const std::vector<uint8_t> last(n_blocks, kLast);
  AlignedBytes samples(64 * n_blocks);
  for (auto _ : state) {
    for_each_row_of_blocks(n_blocks, [&](size_t at, size_t n) {
      table.block.idct_islow(&levels[64 * at], steps.data(), &last[at], n, samples.data() + 64 * at,
                             static_cast<ptrdiff_t>(8 * n));
    });
    benchmark::ClobberMemory();
  }
  count_blocks(state, n_blocks, 192);
}

void bench_quantize(benchmark::State& state, const Kernels& table, size_t bytes) {
  const size_t n_blocks = bytes / 264;
  std::vector<int16_t> coefficients(64 * n_blocks), levels(64 * n_blocks);
  std::vector<uint64_t> nonzero(n_blocks);
  for (size_t i = 0; i < coefficients.size(); ++i)
    coefficients[i] = static_cast<int16_t>(static_cast<int>(i * 2654435761u >> 8 & 511) - 256);
  BlockQuantizer quantizer;
  for (size_t i = 0; i < 64; ++i) {
    quantizer.reciprocal[i] = 1 << 15;  // with this scale: divides by 128
    quantizer.scale[i] = 1 << 10;
    quantizer.bias[i] = 64;
  }
  for (auto _ : state) {
    for_each_row_of_blocks(n_blocks, [&](size_t at, size_t n) {
      table.block.quantize(&coefficients[64 * at], quantizer, n, &levels[64 * at], &nonzero[at]);
    });
    benchmark::ClobberMemory();
  }
  count_blocks(state, n_blocks, 264);
}

[[maybe_unused]] const bool kRegistered = [] {
  register_pixel_kernels();
  register_for_each("fdct8x8", bench_fdct);
  register_for_each("idct8x8_dc", bench_idct<0>);
  register_for_each("idct8x8_last9", bench_idct<9>);
  register_for_each("idct8x8", bench_idct<63>);
  register_for_each("idct4x4", bench_reduced_idct<4>);
  register_for_each("idct2x2", bench_reduced_idct<2>);
  register_for_each("quantize8x8", bench_quantize);
  return true;
}();

}  // namespace
