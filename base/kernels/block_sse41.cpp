#include "base/kernels/block_kernels.h"

namespace pac {

void fill_block_sse41(BlockKernels& table) {
  static_cast<void>(table);
}

}  // namespace pac
