// Decompression of deflate [RFC 1951] and zlib [RFC 1950] streams into a buffer of known size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"

namespace pac {

struct InflateSizes {
  size_t n_read = 0;     // bytes of input that the stream occupies
  size_t n_written = 0;  // bytes of output that it produced
};

// Decompresses one raw deflate stream from the front of `in`. Never writes past `out`, so a small input cannot claim
// more memory than the caller allotted. Fails with truncated (the input ends first), corrupt, or out_of_space (the
// stream holds more than out.size() bytes); offsets count from in's first byte. After a failure `out` holds a prefix.
Result<InflateSizes> inflate(std::span<const uint8_t> in, std::span<uint8_t> out);

// The same for a zlib stream: header checked (method 8, no preset dictionary), Adler-32 verified.
Result<InflateSizes> inflate_zlib(std::span<const uint8_t> in, std::span<uint8_t> out);

}  // namespace pac
