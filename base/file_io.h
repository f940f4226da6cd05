// Whole files in and out, by C stdio. "-" is stdin or stdout.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace pac {

using Bytes = std::vector<uint8_t>;

// The whole file. Fails with io (cannot open or read; a directory) or limit_exceeded (longer than limits.max_bytes).
Result<Bytes> read_file(const std::string& path, const Limits& limits = {});

// Writes a temporary file beside `path`, then renames it: `path` holds all of `bytes` or is untouched.
Result<void> write_file(const std::string& path, std::span<const uint8_t> bytes);

}  // namespace pac
