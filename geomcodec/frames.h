// Frames of a sequence: a mesh coded against a reference with the same faces, so that it costs only what changed. For
// meshes that move and for views of a model under a moving camera, where last frame's screen coordinates map to this
// frame's by a matrix. FORMAT.md section 14. Functions are independent and thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/geomcodec.h"

namespace pac::geomcodec {

// Where a frame expects the reference's vertices: grid numbers (x, y, z, 1) of the reference to the frame's,
// homogeneous and in integers, so that every machine expects the same. at = round(row i . (x, y, z, 1) / row 3 . (x, y,
// z, 1)), clamped to the frame's grid; (x, y, z) itself, clamped, where the divisor is not positive. Columns 0 to 2 are
// within
// +-2^42, column 3 within +-2^58. As constructed: everything stays where it is.
struct FrameMotion {
  int64_t row[4][4] = {{int64_t{1} << 30, 0, 0, 0},
                       {0, int64_t{1} << 30, 0, 0},
                       {0, 0, int64_t{1} << 30, 0},
                       {0, 0, 0, int64_t{1} << 30}};
  bool operator==(const FrameMotion&) const = default;
};

// A 4x4 matrix (rows, for column vectors) from positions on grid `from` to positions on grid `to`, say this frame's
// camera times the inverse of the last one's. Fails with bad_argument: a number that is not finite, a last row of
// zeros, a step that is not positive and finite.
Result<FrameMotion> frame_motion(const double (&matrix)[4][4], const Grid& from, const Grid& to);

// The reference with its positions on another grid, exactly where `motion` expects them: encode_frame() then has
// nothing left to say about positions. Everything else stays.
QuantizedMesh moved(const QuantizedMesh& reference, const FrameMotion& motion, const Grid& grid);
// The grid a mesh's positions are on.
Grid grid_of(const QuantizedMesh& mesh);

struct FrameOptions {
  // Where the caller expects the vertices (null: the encoder looks for a motion by itself, and for one that serves
  // better in any case).
  const FrameMotion* motion = nullptr;
  bool decoder_has_motion = false;  // the caller passes the same `motion` to decode_frame(): it is not in the stream
};

// What a frame costs; the parts add up to the stream. A part that did not change costs nothing.
struct FrameSize {
  uint64_t header_bytes = 0;  // with the motion
  uint64_t position_bytes = 0, color_bytes = 0, normal_bytes = 0, texcoord_bytes = 0;
};

// `mesh` must have the faces (corners, materials), vertex count and normal and texture grids of `reference`; its
// position grid may be another. `reference` is what the decoder will have: what decode() or decode_frame() returned.
// Fails with bad_argument if they do not fit together, or as encode() does.
Result<std::vector<uint8_t>> encode_frame(const QuantizedMesh& mesh, const QuantizedMesh& reference,
                                          const FrameOptions& options = {}, FrameSize* size = nullptr);

// The inverse, bit for bit (indices packed as in `reference`). `motion`: as given to encode_frame() with
// decoder_has_motion. Fails with truncated, corrupt, unsupported as decode() does, bad_argument if the stream needs a
// motion and there is none, and corrupt ("another reference frame") if reference or motion are not the encoder's.
// limits: max_bytes for the decoded vertices.
Result<QuantizedMesh> decode_frame(std::span<const uint8_t> bytes, const QuantizedMesh& reference,
                                   const FrameMotion* motion = nullptr, const Limits& limits = {});

}  // namespace pac::geomcodec
