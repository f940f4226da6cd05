#include "base/kernels/pixel_kernels.h"

namespace pac {

void fill_pixel_avx2(PixelKernels& table) {
  static_cast<void>(table);
}

}  // namespace pac
