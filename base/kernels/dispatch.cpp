// The only file that knows every instruction set. PAC_HAVE_* are set by the build for the ISA files that it compiles.
#include <atomic>
#include <string_view>

#include "base/kernels/kernels.h"

namespace pac {
namespace {

struct IsaEntry {
  Isa isa;
  const char* name;
  bool built;
};

#ifdef PAC_HAVE_SSE41
constexpr bool kHaveSse41 = true;
#else
constexpr bool kHaveSse41 = false;
#endif
#ifdef PAC_HAVE_AVX2
constexpr bool kHaveAvx2 = true;
#else
constexpr bool kHaveAvx2 = false;
#endif
#ifdef PAC_HAVE_NEON
constexpr bool kHaveNeon = true;
#else
constexpr bool kHaveNeon = false;
#endif

constexpr IsaEntry kIsas[kIsaCount] = {
    {Isa::scalar, "scalar", true},
    {Isa::sse41, "sse41", kHaveSse41},
    {Isa::avx2, "avx2", kHaveAvx2},
    {Isa::neon, "neon", kHaveNeon},
};

void fill(Kernels& table, Isa isa) {
  table.isa = isa;
  fill_block_scalar(table.block);
  fill_reduced_idct_scalar(table.block);
  fill_motion_scalar(table.motion);
  fill_pixel_scalar(table.pixel);
  fill_front_scalar(table.front);
  fill_tile_scalar(table.tile);
  fill_grid_scalar(table.tile);
  fill_warp_scalar(table.warp);
#ifdef PAC_HAVE_SSE41
  if (isa == Isa::sse41 || isa == Isa::avx2) {
    fill_block_sse41(table.block);
    fill_reduced_idct_sse41(table.block);
    fill_motion_sse41(table.motion);
    fill_pixel_sse41(table.pixel);
    fill_front_sse41(table.front);
    fill_tile_sse41(table.tile);
    fill_warp_sse41(table.warp);
  }
#endif
#ifdef PAC_HAVE_AVX2
  if (isa == Isa::avx2) {
    fill_block_avx2(table.block);
    fill_reduced_idct_avx2(table.block);
    fill_motion_avx2(table.motion);
    fill_pixel_avx2(table.pixel);
    fill_front_avx2(table.front);
    fill_tile_avx2(table.tile);
    fill_warp_avx2(table.warp);
    fill_warp_filters_avx2(table.warp);
    fill_warp_edges_avx2(table.warp);
    fill_warp_rows_avx2(table.warp);
  }
#endif
#ifdef PAC_HAVE_NEON
  if (isa == Isa::neon) {
    fill_block_neon(table.block);
    fill_reduced_idct_neon(table.block);
    fill_motion_neon(table.motion);
    fill_pixel_neon(table.pixel);
    fill_front_neon(table.front);
    fill_tile_neon(table.tile);
    fill_warp_neon(table.warp);
  }
#endif
}

constinit Kernels g_tables[kIsaCount] = {};   // written once, under kFilling; constant afterwards
std::atomic<const Kernels*> g_best{nullptr};  // set last, so that seeing it means seeing g_tables

enum FillState : int { kEmpty, kFilling, kFilled };
std::atomic<int> g_fill_state{kEmpty};

void fill_tables() {
  int expected = kEmpty;
  if (g_fill_state.compare_exchange_strong(expected, kFilling)) {
    for (const IsaEntry& entry : kIsas)
      if (entry.built && isa_is_supported(entry.isa)) fill(g_tables[static_cast<int>(entry.isa)], entry.isa);
    g_best.store(&g_tables[static_cast<int>(best_isa())], std::memory_order_release);
    g_fill_state.store(kFilled, std::memory_order_release);
  }
  while (g_fill_state.load(std::memory_order_acquire) != kFilled) {
  }
}

}  // namespace

const char* isa_name(Isa isa) {
  return kIsas[static_cast<int>(isa)].name;
}

bool parse_isa(std::string_view name, Isa& isa) {
  for (const IsaEntry& entry : kIsas) {
    if (name != entry.name) continue;
    isa = entry.isa;
    return true;
  }
  return false;
}

bool isa_is_built(Isa isa) {
  return kIsas[static_cast<int>(isa)].built;
}

bool isa_is_supported(Isa isa) {
  switch (isa) {
    case Isa::scalar:
      return true;
#if defined(__x86_64__) || defined(__i386__)
    case Isa::sse41:
      return __builtin_cpu_supports("sse4.1") != 0;
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") != 0;
#endif
#if defined(__aarch64__)
    case Isa::neon:
      return true;
#endif
    default:
      return false;
  }
}

bool override_best_isa(Isa isa) {
  const Kernels* table = kernels_for(isa);
  if (table == nullptr) return false;
  g_best.store(table, std::memory_order_release);
  return true;
}

Isa best_isa() {
  if (const Kernels* chosen = g_best.load(std::memory_order_acquire)) return chosen->isa;
  Isa best = Isa::scalar;
  for (const IsaEntry& entry : kIsas)
    if (entry.built && isa_is_supported(entry.isa)) best = entry.isa;
  return best;
}

const Kernels* kernels_for(Isa isa) {
  if (!isa_is_built(isa) || !isa_is_supported(isa)) return nullptr;
  if (g_fill_state.load(std::memory_order_acquire) != kFilled) fill_tables();
  return &g_tables[static_cast<int>(isa)];
}

const Kernels& kernels() {
  const Kernels* best = g_best.load(std::memory_order_acquire);
  if (best == nullptr) {
    fill_tables();
    best = g_best.load(std::memory_order_acquire);
  }
  return *best;
}

}  // namespace pac
