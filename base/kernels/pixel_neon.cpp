#include "base/kernels/pixel_kernels.h"

namespace pac {

void fill_pixel_neon(PixelKernels& table) {
  static_cast<void>(table);
}

}  // namespace pac
