// Quantization tables from a text file.
#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "jpeg/jpeg.h"

namespace pac::cli {

// 64 numbers of 1..255 for luma and, optionally, 64 for chroma (else the same), in row order as the IJG software reads
// them; # starts a comment. Fails with corrupt at the offset of what is no such number, or where their count is neither
// 64 nor 128.
Result<jpeg::QuantTables> read_tables(std::span<const uint8_t> text);

// The tables at a quality in (0, 100]: they count as those of quality 50 and scale as Annex K's do.
jpeg::QuantTables scale_tables(const jpeg::QuantTables& tables, double quality);

}  // namespace pac::cli
