// Which quality made a table.
#pragma once

#include "jpeg/jpeg.h"

namespace pac::jpeg {

// The real-valued IJG quality whose Annex K luma table comes nearest (least sum of absolute differences of steps), to
// 1/10; a whole one where it is as near.
double estimate_quality(const QuantTable& luma);

}  // namespace pac::jpeg
