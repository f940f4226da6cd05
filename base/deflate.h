// Compression to zlib streams [RFC 1950, RFC 1951]: LZ77 by hash chains with lazy matching, dynamic Huffman codes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pac {

// A complete zlib stream that inflate_zlib turns back into `in` (shorter than 2^32 - 1 bytes). The output depends on
// nothing but `in`. Never longer than in.size() + in.size() / 4096 + 32 bytes.
std::vector<uint8_t> deflate_zlib(std::span<const uint8_t> in);

}  // namespace pac
