// The kernels of the model's prediction on every instruction set that this machine runs, on rows of 1280 pixels.
//   build/release/bench/pac_bench --benchmark_filter='warp_.*/avx2'
// A camera moves a little past a slope with steps in it: positions between pixels, few points near edges. The rows of a
// picture follow each other, so that data come as far as they do when a picture is predicted.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/kernels/kernels.h"
#include "sim/bordered_plane.h"
#include "sim/surface_map.h"
#include "sim/warp_filter.h"

namespace {

using namespace pac;

constexpr int kWidth = 1280, kHeight = 256;
constexpr size_t kColumns = kWidth;

// Depths of a slope that jumps every 160 columns, all of one surface.
void fill_depth(DepthImage& depth, IdImage& id) {
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int step = x / 160 % 2;
      depth.row(y)[x] = 0.3f + 0.2f * static_cast<float>(step) + 0.0001f * static_cast<float>(x % 160 + y);
      id.row(y)[x] = static_cast<uint32_t>(1 + x / 32);
    }
}

// 1 % nearer, a little turned.
ReprojectionRow row_at(int y) {
  const float line = static_cast<float>(y);
  return {
      {13.0f - 0.4f * line, 64.6f * line + 9.0f, 0.0f, 1.0f}, {64.6f, 0.15f, 0.0f, 0.0f}, {20.0f, 4.0f, 1.0f, 0.01f}};
}

// What the kernels read and write, for one instruction set.
struct Picture {
  const WarpKernels& kernels;
  DepthImage depth{kWidth, kHeight};
  IdImage id{kWidth, kHeight};
  sim::SurfaceMap map{kWidth, kHeight};
  sim::BorderedPlane planes[2] = {sim::BorderedPlane(kWidth, kHeight), sim::BorderedPlane(kWidth, kHeight)};
  Image<int32_t, 1> x_64{kWidth, kHeight}, y_64{kWidth, kHeight};
  Image<uint8_t, 1> state{kWidth, kHeight}, base{kWidth, kHeight}, sum{kWidth, kHeight};
  IdImage wanted{kWidth, kHeight}, keys{kWidth, kHeight};
  Image<int16_t, 1> out[2] = {Image<int16_t, 1>(kWidth, kHeight), Image<int16_t, 1>(kWidth, kHeight)};
  std::vector<uint64_t> right = std::vector<uint64_t>(kWidth / 64), down = right;
  int y = 0;

  explicit Picture(const WarpKernels& table) : kernels(table) {
    fill_depth(depth, id);
    for (int row = 0; row < kHeight; ++row) {
      map.set(0, row, kWidth, depth.row(row), id.row(row), {}, kernels);
      map.end_row(row, kernels);
    }
    map.finish(kernels);
    for (sim::BorderedPlane& plane : planes) {
      for (int row = 0; row < kHeight; ++row)
        for (int x = 0; x < kWidth; ++x) plane.row(row)[x] = static_cast<int16_t>((x * 37 + row * 91) % 512 - 256);
      plane.extend();
    }
    for (int row = 0; row < kHeight; ++row)
      kernels.find_points(row_at(row), 0, depth.row(row), map.row(row), map.view(), kColumns, places(row));
  }

  WarpPlaces places(int row) { return {x_64.row(row), y_64.row(row), state.row(row), wanted.row(row)}; }
  const int16_t* taps() const { return sim::kWarpFilter.data(); }
};

template <class DoRow>
void register_rows(const char* kernel, const DoRow& do_row) {
  for (int i = 0; i < kIsaCount; ++i) {
    const Kernels* table = kernels_for(static_cast<Isa>(i));
    if (table == nullptr) continue;
    const std::string name = std::string("warp_") + kernel + "/" + isa_name(table->isa);
    benchmark::RegisterBenchmark(name.c_str(), [table, do_row](benchmark::State& state) {
      Picture picture(table->warp);
      for (auto _ : state) {
        do_row(picture, picture.y);
        picture.y = (picture.y + 1) % kHeight;
        benchmark::ClobberMemory();
      }
      state.SetItemsProcessed(state.iterations() * kWidth);
    });
  }
}

[[maybe_unused]] const bool kRegistered = [] {
  register_rows("surface_keys_row", [](Picture& p, int y) {
    p.kernels.surface_keys_row(p.id.row(y), p.depth.row(y), nullptr, 0, kColumns, p.keys.row(y));
  });
  register_rows("compare_keys", [](Picture& p, int y) {
    p.kernels.compare_keys(p.map.row(y > 0 ? y - 1 : 0), p.map.row(y), kColumns, p.right.data(), p.down.data());
  });
  register_rows("mark_smooth",
                [](Picture& p, int y) { p.kernels.mark_smooth(p.right.data(), kColumns, p.keys.row(y)); });
  register_rows("find_points", [](Picture& p, int y) {
    p.kernels.find_points(row_at(y), 0, p.depth.row(y), p.map.row(y), p.map.view(), kColumns, p.places(y));
  });
  register_rows("filter_points", [](Picture& p, int y) {
    p.kernels.filter_points(p.planes[0].row(0), p.planes[0].stride(), p.taps(), p.x_64.row(y), p.y_64.row(y),
                            p.state.row(y), kColumns, p.out[0].row(y));
  });
  register_rows("filter_both", [](Picture& p, int y) {
    const int16_t* const planes[2] = {p.planes[0].row(0), p.planes[1].row(0)};
    int16_t* const out[2] = {p.out[0].row(y), p.out[1].row(y)};
    p.kernels.filter_both(planes, p.planes[0].stride(), p.taps(), p.x_64.row(y), p.y_64.row(y), p.state.row(y),
                          kColumns, out);
  });
  register_rows("filter_edges", [](Picture& p, int y) {
    p.kernels.filter_edges(p.planes[0].row(0), p.planes[0].stride(), p.map.view(), p.taps(), p.places(y), kColumns,
                           p.out[0].row(y));
  });
  register_rows("mean_edges", [](Picture& p, int y) {
    const int16_t* const planes[2] = {p.planes[0].row(0), p.planes[1].row(0)};
    int16_t* const out[2] = {p.out[0].row(y), p.out[1].row(y)};
    p.kernels.mean_edges(planes, p.planes[0].stride(), p.map.view(), p.places(y), kColumns, out);
  });
  register_rows("add_carried_row", [](Picture& p, int y) {
    p.kernels.add_carried_row(p.base.row(y), p.out[0].row(y), kColumns, p.sum.row(y));
  });
  return true;
}();

}  // namespace
