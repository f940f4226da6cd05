#include "base/kernels/tile_kernels.h"

namespace pac {

void fill_tile_avx2(TileKernels& table) {
  static_cast<void>(table);
}

}  // namespace pac
