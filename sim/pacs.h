// The .pacs file: what a server sent, in order. "PACS", then each message (the session message first, then the frame
// packets) as its length (u32, little-endian) and its bytes. No index, so that it can be written as it is sent.
#pragma once

#include <span>
#include <vector>

#include "base/file_io.h"
#include "base/result.h"

namespace pac::sim {

// Appends; the first call on an empty `out` writes the magic, too.
void append_pacs_message(Bytes& out, std::span<const uint8_t> message);

// The messages; spans point into `bytes`. Fails with corrupt (magic) or truncated (a length beyond the end; byte_offset
// is the length's).
Result<std::vector<std::span<const uint8_t>>> read_pacs(std::span<const uint8_t> bytes);

}  // namespace pac::sim
