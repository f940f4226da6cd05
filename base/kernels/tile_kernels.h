// Rasterization inside one tile: coverage from edge functions, depth test, interpolation, texture filter.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

struct TileKernels {};

// One per instruction set: overwrites the entries that it improves.
void fill_tile_scalar(TileKernels& table);
void fill_tile_sse41(TileKernels& table);
void fill_tile_avx2(TileKernels& table);
void fill_tile_neon(TileKernels& table);

}  // namespace pac
