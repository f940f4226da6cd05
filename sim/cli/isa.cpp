// `pac isa`: which instruction sets are built, which this processor has, and whose code each kernel runs.
#include <cstdio>

#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "sim/cli/command.h"

namespace pac::cli {
namespace {

constexpr Isa kAll[] = {Isa::scalar, Isa::sse41, Isa::avx2, Isa::neon};

using AnyFunction = void (*)();

struct Kernel {
  const char* family;
  const char* name;
  AnyFunction (*entry)(const Kernels& table);
};

#define PAC_KERNEL(family, name)                                                                          \
  Kernel {                                                                                                \
#family, #name, [](const Kernels& table) { return reinterpret_cast<AnyFunction>(table.family.name); } \
  }

// Every entry of the four families (a test counts them).
const Kernel kKernelList[] = {
    PAC_KERNEL(block, fdct_islow),
    PAC_KERNEL(block, idct_islow),
    PAC_KERNEL(block, idct_4x4),
    PAC_KERNEL(block, idct_2x2),
    PAC_KERNEL(block, idct_1x1),
    PAC_KERNEL(block, quantize),
    PAC_KERNEL(block, fdct_quantize),
    PAC_KERNEL(motion, sad16),
    PAC_KERNEL(motion, sad16_x4),
    PAC_KERNEL(motion, sad16_quarters),
    PAC_KERNEL(motion, sad8),
    PAC_KERNEL(motion, satd16),
    PAC_KERNEL(motion, sse),
    PAC_KERNEL(motion, moments16),
    PAC_KERNEL(motion, sad8_across),
    PAC_KERNEL(motion, means_4x4),
    PAC_KERNEL(motion, average),
    PAC_KERNEL(motion, fdct_macroblock),
    PAC_KERNEL(motion, fdct_reaching),
    PAC_KERNEL(motion, idct_add),
    PAC_KERNEL(motion, idct_put),
    PAC_KERNEL(motion, idct_dc_add),
    PAC_KERNEL(motion, sad16_half[0]),
    PAC_KERNEL(motion, sad16_half[1]),
    PAC_KERNEL(motion, sad16_half[2]),
    PAC_KERNEL(motion, sad16_half[3]),
    PAC_KERNEL(motion, predict16[0]),
    PAC_KERNEL(motion, predict16[1]),
    PAC_KERNEL(motion, predict16[2]),
    PAC_KERNEL(motion, predict16[3]),
    PAC_KERNEL(motion, predict8_pair[0]),
    PAC_KERNEL(motion, predict8_pair[1]),
    PAC_KERNEL(motion, predict8_pair[2]),
    PAC_KERNEL(motion, predict8_pair[3]),
    PAC_KERNEL(pixel, difference_row),
    PAC_KERNEL(pixel, composite_row),
    PAC_KERNEL(pixel, ycc_from_rgb_row),
    PAC_KERNEL(pixel, ycc420_from_rgb_rows),
    PAC_KERNEL(pixel, rgb_from_ycc_row),
    PAC_KERNEL(pixel, downsample_h2v1_row),
    PAC_KERNEL(pixel, downsample_h2v2_row),
    PAC_KERNEL(pixel, upsample_h2v1_row),
    PAC_KERNEL(pixel, upsample_h2v2_row),
    PAC_KERNEL(pixel, upsample_h1v2_row),
    PAC_KERNEL(pixel, rgb_from_ycc420_row),
    PAC_KERNEL(front, transform_vertices),
    PAC_KERNEL(front, setup_triangles),
    PAC_KERNEL(front, keeps_normals),
    PAC_KERNEL(front, faces_eye),
    PAC_KERNEL(front, gather_vertices),
    PAC_KERNEL(front, color_records),
    PAC_KERNEL(front, lit_records),
    PAC_KERNEL(tile, rasterize),
    PAC_KERNEL(tile, rasterize_all),
    PAC_KERNEL(tile, rasterize_grid),
    PAC_KERNEL(tile, first_sample),
    PAC_KERNEL(tile, collect_grid),
    PAC_KERNEL(tile, paint_grid),
    PAC_KERNEL(tile, collect_packs),
    PAC_KERNEL(tile, interpolate),
    PAC_KERNEL(tile, interpolate_lanes),
    PAC_KERNEL(tile, light),
    PAC_KERNEL(tile, occluded),
    PAC_KERNEL(tile, sample_texture),
    PAC_KERNEL(tile, footprint),
    PAC_KERNEL(tile, sample_anisotropic),
    PAC_KERNEL(tile, sample_alpha),
    PAC_KERNEL(tile, bend_normals),
    PAC_KERNEL(tile, reflect),
    PAC_KERNEL(tile, fog),
    PAC_KERNEL(tile, shadow_map),
    PAC_KERNEL(tile, blend),
    PAC_KERNEL(tile, accumulate),
    PAC_KERNEL(tile, accumulate_lanes),
    PAC_KERNEL(tile, collect_groups),
    PAC_KERNEL(tile, interpolate_groups),
    PAC_KERNEL(tile, add_colors),
    PAC_KERNEL(tile, paint_colors),
    PAC_KERNEL(tile, add_textured),
    PAC_KERNEL(tile, add_textured_grid),
    PAC_KERNEL(tile, paint_textured),
    PAC_KERNEL(tile, resolve_row),
    PAC_KERNEL(warp, reproject_row),
    PAC_KERNEL(warp, filter_points),
    PAC_KERNEL(warp, filter_both),
    PAC_KERNEL(warp, surface_keys_row),
    PAC_KERNEL(warp, find_points),
    PAC_KERNEL(warp, find_half_points),
    PAC_KERNEL(warp, compare_keys),
    PAC_KERNEL(warp, mark_smooth),
    PAC_KERNEL(warp, filter_edges),
    PAC_KERNEL(warp, mean_edges),
    PAC_KERNEL(warp, add_carried_row),
    PAC_KERNEL(warp, upsample_carried_row),
    PAC_KERNEL(warp, composite_signed_row),
};

// The first instruction set, in ascending order, whose table holds the same function: its file exports it.
Isa origin(const Kernel& kernel, const Kernels& table) {
  for (const Isa isa : kAll) {
    const Kernels* other = kernels_for(isa);
    if (other != nullptr && kernel.entry(*other) == kernel.entry(table)) return isa;
  }
  return table.isa;
}

void print_table(const Kernels& table) {
  std::printf("%-8s %-6s %s\n", "isa", "built", "supported");
  for (const Isa isa : kAll)
    std::printf("%-8s %-6s %s%s\n", isa_name(isa), isa_is_built(isa) ? "yes" : "no",
                isa_is_supported(isa) ? "yes" : "no", isa == table.isa ? "   <- in use" : "");
  std::printf("threads  %d\n\n%-7s %-28s %s\n", hardware_thread_count(), "family", "kernel", "uses");
  for (const Kernel& kernel : kKernelList)
    std::printf("%-7s %-28s %s\n", kernel.family, kernel.name, isa_name(origin(kernel, table)));
}

int print_as_json(const Kernels& table) {
  sim::JsonWriter json;
  json.begin_object();
  json.field("isa", isa_name(table.isa));
  json.field("threads", hardware_thread_count());
  json.begin_array("instruction_sets");
  for (const Isa isa : kAll) {
    json.begin_object();
    json.field("name", isa_name(isa));
    json.field("built", isa_is_built(isa));
    json.field("supported", isa_is_supported(isa));
    json.end_object();
  }
  json.end_array();
  json.begin_array("kernels");
  for (const Kernel& kernel : kKernelList) {
    json.begin_object();
    json.field("family", kernel.family);
    json.field("name", kernel.name);
    json.field("uses", isa_name(origin(kernel, table)));
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return print_json(json);
}

}  // namespace

int run_isa(Args args) {
  Options options("isa", "which implementation each kernel uses, and which are built", "pac isa");
  if (const auto code = options.parse(args)) return *code;
  const Kernels& table = *kernels_for(options.isa);
  if (options.json) return print_as_json(table);
  print_table(table);
  return kDone;
}

}  // namespace pac::cli
