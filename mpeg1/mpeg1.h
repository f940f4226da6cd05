// MPEG-1 video [ISO/IEC 11172-2]: the public face of the codec.
// The codec itself arrives with its own change; this header fixes what can be agreed on before: the picture format.
#pragma once

#include <cstdint>

#include "base/image.h"
#include "base/result.h"

namespace pac::mpeg1 {

// Legal frame rates [11172-2 2.4.3.2, picture_rate], in 1/1000 frames a second; index = picture_rate code.
constexpr int kPictureRatesMilli[9] = {0, 23976, 24000, 25000, 29970, 30000, 50000, 59940, 60000};

// The paper's 20 frames a second is no legal picture_rate: the code of the nearest one that is not slower.
constexpr int picture_rate_code(int rate_milli) {
  for (int code = 1; code <= 8; ++code)
    if (kPictureRatesMilli[code] >= rate_milli) return code;
  return 8;
}

}  // namespace pac::mpeg1
