#include "base/kernels/motion_kernels.h"

namespace pac {

void fill_motion_neon(MotionKernels&) {}

}  // namespace pac
