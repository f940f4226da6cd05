// 8x8 block operations: forward and inverse DCT, quantization. Blocks are 64 int16 in natural (row) order.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

struct BlockKernels {};

// One per instruction set: overwrites the entries that it improves.
void fill_block_scalar(BlockKernels& table);
void fill_block_sse41(BlockKernels& table);
void fill_block_avx2(BlockKernels& table);
void fill_block_neon(BlockKernels& table);

}  // namespace pac
