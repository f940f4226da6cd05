// Where `pac jpeg encode` takes its quantization tables from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "jpeg/jpeg.h"
#include "sim/table_family.h"

namespace pac::cli {

// A pair of tables for each quality on the IJG scale.
class TableSource {
 public:
  // Annex K's, or designed for `image` [see sim/table_family.h].
  static Result<TableSource> family(sim::TableFamily family, ConstRgbView image, jpeg::Subsampling subsampling);

  // A text with 64 numbers of 1..255 for luma and, optionally, 64 for chroma (else the same), in row order as the IJG
  // software reads them; # starts a comment. Quality 50 gives them as they are, others scale them as Annex K's. Fails
  // with corrupt at the offset of what is no such number, or where their count is neither 64 nor 128.
  static Result<TableSource> from_text(std::span<const uint8_t> text);

  jpeg::QuantTables at_quality(double quality) const;  // (0, 100]
  std::vector<double> step_qualities() const;          // finest tables first
  const char* name() const { return name_; }

 private:
  const char* name_ = "";
  std::optional<sim::ScaledTables> scaled_;
  jpeg::QuantTables fixed_;  // where scaled_ is empty
};

}  // namespace pac::cli
