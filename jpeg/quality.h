// Which quality made a table.
#pragma once

#include "jpeg/jpeg.h"

namespace pac::jpeg {

// The real-valued IJG quality whose Annex K luma table comes nearest (least sum of absolute differences of steps), to
// 1/10; among equals the one nearest to the middle of their run.
double estimate_quality(const QuantTable& luma);

}  // namespace pac::jpeg
