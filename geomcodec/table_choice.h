// Which sections of a small mesh tables code: an encoder's choice between bytes and a decoder's time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geomcodec/container.h"

namespace pac::geomcodec {

using Sections = std::array<std::vector<uint8_t>, kSections>;

// What the mesh takes by other means.
struct PlainBytes {
  int64_t connectivity = 0;  // as we code it adaptively
  int64_t positions = 0;     // by a coder without contexts
  int64_t all = 0;           // and faces

  PlainBytes() = default;
  PlainBytes(size_t connectivity_bytes, uint64_t position_bytes)
      : connectivity(static_cast<int64_t>(connectivity_bytes)),
        positions(static_cast<int64_t>(position_bytes)),
        all(positions + connectivity * 11 / 10) {}
  // Where we code connectivity by tables, which takes about a tenth more.
  static PlainBytes beside_tables(size_t connectivity_bytes, uint64_t position_bytes) {
    PlainBytes plain(connectivity_bytes, position_bytes);
    plain.all = plain.positions + plain.connectivity;
    return plain;
  }
  // Positions as good as uncompressed: nothing is faster than those without any coding.
  bool are_raw(const Header& header) const;
  // Whether positions in so many bytes, and faces, are so near to it that the estimate's errors count.
  bool is_tight(size_t position_bytes) const;
  // Whether positions by tables are few enough: whatever the other coding takes not, if this is false; where it takes
  // about `adaptive_bytes`.
  bool tables_may_suffice(size_t bytes_by_tables) const;
  bool tables_suffice(size_t bytes_by_tables, size_t adaptive_bytes) const;
};

// Where residuals choose what they start from, tables may make faces grow by this part of the geometry: they save a
// smaller part of a decoder's time.
inline constexpr int64_t kGrowthBesideChoosing = 96;

// Of the sections that may be either, those by tables that save a decoder most time within the room that there is move
// to `sections`, and the header says so; none where these are so few bytes that a table's own would show. What is by
// tables already stays so, having grown by so many bytes.
void keep_fastest(Header& header, const PlainBytes& plain, int64_t grown, Sections& sections, Sections& by_tables);

}  // namespace pac::geomcodec
