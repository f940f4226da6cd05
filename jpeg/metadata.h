// What a JPEG file carries beside its picture: color profile, camera data, comments, density. Nothing here changes a
// pixel.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace pac::jpeg {

// How many pixels lie on an inch or a centimeter, or only the pixels' shape (JFIF APP0, 1.02 p.5).
struct Density {
  enum class Unit : uint8_t { aspect_ratio, per_inch, per_cm };
  Unit unit = Unit::aspect_ratio;
  int x = 1, y = 1;  // 1..65535
};

// Owned bytes; an empty field means that there is no such segment.
struct Metadata {
  Density density;
  std::vector<uint8_t> exif;          // the TIFF structure behind "Exif\0\0" (APP1); at most 65527 bytes
  std::vector<uint8_t> xmp;           // the packet behind its name (APP1); at most 65504 bytes
  std::vector<uint8_t> icc_profile;   // joined from its segments (APP2); at most 255 * 65519 bytes
  std::vector<std::string> comments;  // COM, any bytes, usually text; at most 65533 bytes each

  bool operator==(const Metadata& other) const;
};

struct MetadataFound {
  Metadata metadata;
  int warnings = 0;  // segments that break their rules and were left out: an incomplete profile, a second Exif, ...
};

// From the segments before the first scan. Broken metadata never makes a file unreadable. Errors: as read_info().
Result<MetadataFound> read_metadata(std::span<const uint8_t> file, const Limits& limits = {});

// The file with `metadata` instead of its own; all other segments and the entropy-coded data stay as they are (Adobe's
// APP14 too: it tells the colors). Errors: as read_info(); bad_argument (check_metadata).
Result<std::vector<uint8_t>> with_metadata(std::span<const uint8_t> file, const Metadata& metadata,
                                           const Limits& limits = {});

// bad_argument where a field exceeds what its comment says.
Result<void> check_metadata(const Metadata& metadata);
// Bytes that a file grows by: everything but the JFIF segment, which every file has.
uint64_t metadata_bytes(const Metadata& metadata);

}  // namespace pac::jpeg
