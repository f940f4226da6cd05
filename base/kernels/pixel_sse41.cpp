#include "base/kernels/pixel_kernels.h"

namespace pac {

void fill_pixel_sse41(PixelKernels& table) {
  static_cast<void>(table);
}

}  // namespace pac
