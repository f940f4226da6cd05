// decode_frame(): the motion's expectation, then what changed against it.
#include <algorithm>

#include "geomcodec/frame_coder.h"
#include "geomcodec/frame_motion.h"
#include "geomcodec/mesh_check.h"

namespace pac::geomcodec {
namespace {

Result<void> check_reference(const FrameHeader& header, const QuantizedMesh& reference, const FrameMotion* motion,
                             const Limits& limits) {
  PAC_CHECK(check_mesh(reference));
  if (uint64_t{header.n_vertices} * sizeof(QuantizedVertex) > limits.max_bytes)
    return Failure{Error::limit_exceeded, 0, "decoded mesh is larger than the limit"};
  const bool callers = header.motion_kind == MotionKind::callers;
  if (callers && (motion == nullptr || !within_bounds(*motion)))
    return Failure{Error::bad_argument, 0, "the frame needs the caller's motion"};
  if (header.n_vertices != reference.vertices.size() ||
      header.reference_checksum != reference_checksum(reference, callers ? motion : nullptr))
    return Failure{Error::corrupt, 0, "the frame belongs to another reference frame"};
  if ((header.changed[kFrameNormals] && reference.normal_bits == 0) ||
      (header.changed[kFrameTexcoords] && reference.texcoord_bits == 0))
    return Failure{Error::corrupt, 0, "the frame changes what its reference has not"};
  return {};
}

// `frame` holds what is expected and receives what is.
Result<void> decode_group(const ParsedFrame& stream, FrameGroup group, const FrameNeighbors& neighbors,
                          std::span<const uint32_t> sibling, QuantizedMesh& frame) {
  const auto damaged = [&](const char* text) { return Failure{Error::corrupt, stream.section_offset(group), text}; };
  RangeDecoder range_coder(stream.section[group]);
  const FrameValues expected = frame_values(group, frame.vertices);
  FrameValues values(expected.size());
  FrameCoder<RangeDecoder> coder(neighbors, sibling, expected, frame_shape(group, frame), range_coder);
  if (!coder.begin({})) return damaged("a part of the frame has a head that no encoder writes");
  for (uint32_t v = 0; v < values.size(); ++v) {
    if (!coder.code(v, values)) return damaged("a value of the frame is above its grid");
    if (range_coder.failed()) return damaged("a part of the frame ends too early");
  }
  if (!range_coder.ends_exactly()) return damaged("a part of the frame does not end where the header says");
  set_frame_values(group, values, frame.vertices);
  return {};
}

}  // namespace

Result<QuantizedMesh> decode_frame(std::span<const uint8_t> bytes, const QuantizedMesh& reference,
                                   const FrameMotion* motion, const Limits& limits) {
  PAC_TRY(const ParsedFrame stream, parse_frame(bytes));
  const FrameHeader& header = stream.header;
  PAC_CHECK(check_reference(header, reference, motion, limits));
  const FrameMotion& taken = header.motion_kind == MotionKind::callers ? *motion : header.motion;
  QuantizedMesh frame = moved(reference, taken, header.own_grid ? header.grid : grid_of(reference));
  const FrameNeighbors neighbors(reference);
  for (const FrameGroup group : {kFramePositions, kFrameColors, kFrameNormals, kFrameTexcoords}) {
    if (!header.changed[group]) continue;
    std::vector<uint32_t> sibling;
    if (group == kFramePositions) sibling = frame_siblings(reference.vertices);
    PAC_CHECK(decode_group(stream, group, neighbors, sibling, frame));
  }
  return frame;
}

}  // namespace pac::geomcodec
