// Sequences slower than their picture_rate: every stream of I and P pictures at the speed that it was made for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

// Picture `n_written` (from 0) is due before the source's picture n_source (from 0), which comes rate_milli / 1000 a
// second.
constexpr bool is_repeat_due(uint64_t n_written, uint64_t n_source, uint64_t rate_milli, int picture_rate_code) {
  const auto legal = static_cast<uint64_t>(kPictureRatesMilli[picture_rate_code]);
  return (2 * n_written + 1) * rate_milli < 2 * n_source * legal;
}

// An elementary stream of I and P pictures that are to be shown rate_milli / 1000 a second, less than its picture_rate
// says, with a P picture of skipped macroblocks (some 20 bytes) wherever the picture before is due again; temporal
// references and time codes follow, sequence_end_code is there at the end. A stream that is not slower comes back with
// that code alone. Macroblocks that begin and end a picture are coded in every one of them: of the 132 predicted
// codings between intra ones [2.4.4.2] the repeats take their share. Fails with corrupt where a header cannot be read,
// unsupported where there are B pictures or a constant bit rate, whose vbv_delay would be wrong.
Result<std::vector<uint8_t>> with_repeats(std::span<const uint8_t> video, int rate_milli);

}  // namespace pac::mpeg1
