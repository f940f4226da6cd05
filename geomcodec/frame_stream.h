// The header of a frame's stream. FORMAT.md section 14.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/frames.h"

namespace pac::geomcodec {

enum FrameGroup : uint32_t { kFramePositions, kFrameColors, kFrameNormals, kFrameTexcoords, kFrameGroups };

enum class MotionKind : uint8_t { still, in_stream, callers };

struct FrameHeader {
  MotionKind motion_kind = MotionKind::still;
  FrameMotion motion;  // in_stream
  bool own_grid = false;
  Grid grid;  // with own_grid
  uint32_t n_vertices = 0;
  uint32_t reference_checksum = 0;
  std::array<bool, kFrameGroups> changed = {};
};
struct ParsedFrame {
  FrameHeader header;
  uint64_t header_bytes = 0;
  std::array<std::span<const uint8_t>, kFrameGroups> section;  // empty where nothing changed
  uint64_t section_offset(FrameGroup group) const {
    uint64_t offset = header_bytes;
    for (uint32_t i = 0; i < group; ++i) offset += section[i].size();
    return offset;
  }
};

std::vector<uint8_t> write_frame(const FrameHeader& header,
                                 const std::array<std::vector<uint8_t>, kFrameGroups>& sections,
                                 uint64_t& header_bytes);
// Fails with truncated, unsupported (version, flags), corrupt.
Result<ParsedFrame> parse_frame(std::span<const uint8_t> bytes);

// CRC-32 of everything a frame is predicted from; `motion` null unless it is the caller's.
uint32_t reference_checksum(const QuantizedMesh& reference, const FrameMotion* motion);

// Whether the entries are within the bounds that FrameMotion states.
bool within_bounds(const FrameMotion& motion);

}  // namespace pac::geomcodec
