// Lossless compression of quantized polygon meshes: the scheme that Levoy 1995, section 3, proposes and estimates,
// built and with its connectivity counted. FORMAT.md is the byte-exact description. Functions are independent and
// thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"

namespace pac::geomcodec {

// Three fixed-point coordinates and a color: the paper's 10-byte vertex; and, where a mesh has them, a normal and a
// texture coordinate.
struct QuantizedVertex {
  uint16_t position[3] = {0, 0, 0};
  uint8_t color[4] = {255, 255, 255, 255};  // RGBA
  uint16_t normal[2] = {0, 0};              // octahedral: 0 .. 2^normal_bits - 2 each; 0 without normals
  uint16_t texcoord[2] = {0, 0};            // below 2^texcoord_bits; 0 without texture coordinates
  bool operator==(const QuantizedVertex&) const = default;
};

// A lattice of points: coordinate = origin + n * step per axis, n in 0 .. 2^bits - 1.
struct Grid {
  float origin[3] = {0, 0, 0};
  float step[3] = {1, 1, 1};
  int bits = 16;  // 1..16
};

// A mesh on an integer grid. Faces as in base/mesh.h: any number of corners from 3, any indices below vertices.size();
// non-manifold, isolated, duplicate and degenerate parts are all legal. Every coordinate is below 2^position_bits.
struct QuantizedMesh {
  std::vector<QuantizedVertex> vertices;
  std::vector<uint32_t> indices;
  std::vector<Face> faces;
  int position_bits = 16;  // 1..16
  float origin[3] = {0, 0, 0};
  float step[3] = {1, 1, 1};
  int normal_bits = 0;    // 2..16; 0: no normals
  int texcoord_bits = 0;  // 1..16; 0: no texture coordinates
  float texcoord_origin[2] = {0, 0};
  float texcoord_step = 1;
  // Values of faces, such as colors: face_components of face 0, those of face 1, ... Data of corners is that of the
  // vertices: those that share a position are coded once.
  int face_bits = 0;                  // 1..16; 0: no values
  int face_components = 0;            // 1..4; 0 without values
  std::vector<uint16_t> face_values;  // faces.size() * face_components, each below 2^face_bits
};

// The only lossy step: rounds to the nearest point of a cubic grid (one step for the three axes: the longest side of
// the bounding box over 2^position_bits - 1; 1 where the mesh has no extent), halves upwards. Drops normals and texture
// coordinates. Fails with bad_argument (position_bits outside 1..16) or corrupt (a position that is not finite;
// byte_offset = vertex number).
Result<QuantizedMesh> quantize(const Mesh& mesh, int position_bits);

// The same on a grid that the caller fixes, so that meshes and frames share it (screen space: step 1/16 pixel in x and
// y, 2^-16 in z). Positions outside the grid go to its nearest point. Fails also with bad_argument if a step is not
// positive and finite or an origin not finite.
Result<QuantizedMesh> quantize(const Mesh& mesh, const Grid& grid);

// Positions on the fitted grid, and normals and texture coordinates with the bits given (0: dropped). A normal that is
// zero becomes (0, 0, 1). Fails also with bad_argument for bits out of range.
struct AttributeBits {
  int position = 16;  // 1..16
  int normal = 0;     // 0, 2..16 per component
  int texcoord = 0;   // 0, 1..16 along the longer side of their bounding box
};
Result<QuantizedMesh> quantize(const Mesh& mesh, const AttributeBits& bits);

// Vertices that are equal in everything become one, the first of them; vertices that no face uses go. Faces keep their
// order and corners.
QuantizedMesh merge_equal_vertices(const QuantizedMesh& mesh);

// Positions back as floats: float(double(origin) + n * double(step)), the same bits on every machine; normals and
// texture coordinates if there are any.
Mesh dequantize(const QuantizedMesh& mesh);

// What an encoder trades for speed. fast: symbols by tables, in any mesh. balanced: by tables from 16,384 vertices on;
// in smaller meshes of 512 vertices and more that have colors, normals or texture coordinates, and positions of 13 bits
// and more, in the sections that gain a decoder most for a sixteenth more bytes at most. best: adaptive models
// everywhere, and predictions are chosen by coding with each, not by estimates: the fewest bytes.
enum class Effort { fast, balanced, best };

struct EncodeOptions {
  bool keep_order = false;     // vertices, faces and first corners come back in the order given, else as reorder() says
  bool trained_priors = true;  // models start as training on generated meshes left them: small meshes take 2-3 % less
  Effort effort = Effort::balanced;
};

// What each part of an encoded mesh costs. They add up to the size of the stream.
struct EncodedSize {
  uint64_t header_bytes = 0, connectivity_bytes = 0;
  uint64_t seam_bytes = 0;  // which corners at a position share a vertex
  uint64_t position_bytes = 0, color_bytes = 0, normal_bytes = 0, texcoord_bytes = 0, material_bytes = 0,
           face_value_bytes = 0;
  uint64_t order_bytes = 0;  // the permutations that keep_order adds
  uint64_t total_bytes() const {
    return header_bytes + connectivity_bytes + seam_bytes + position_bytes + color_bytes + normal_bytes +
           texcoord_bytes + material_bytes + face_value_bytes + order_bytes;
  }
};

// Section 3's estimate for a model: 10 bytes a vertex, compressed 3:1, one vertex a polygon, connectivity not counted.
inline double levoy95_estimated_bytes(uint64_t n_polygons) {
  return static_cast<double>(n_polygons) * 10.0 / 3.0;
}

// Positions that several vertices share are coded once. Fails with bad_argument: bits out of range, a coordinate above
// its grid, an attribute that the mesh says it has not, values of faces that are not as many as it says, a face that
// base/mesh.h's validate() refuses, more than 2^31 - 1 vertices, faces or corners.
Result<std::vector<uint8_t>> encode(const QuantizedMesh& mesh, const EncodeOptions& options = {},
                                    EncodedSize* size = nullptr);

// The inverse: decode(encode(q, {.keep_order = true})) == q and decode(encode(q)) == reorder(q), both with `indices`
// packed (face i's corners follow those of face i - 1). Rejects whatever encode() could not have written as far as one
// can see: wrong magic, version, checksum, lengths; every strict prefix; trailing bytes. Every index of the result is
// below its vertex count. limits: max_triangles; max_bytes for the decoded arrays, checked while they grow.
Result<QuantizedMesh> decode(std::span<const uint8_t> bytes, const Limits& limits = {});

// The order in which encode() walks a mesh: faces as the walk meets them (FORMAT.md section 4), each rotated so that
// the shared edge it was entered by comes first (orientation is kept), vertices by first appearance, those that no face
// uses last in their old order. Idempotent. The mesh must be one that encode() accepts; else it comes back empty.
QuantizedMesh reorder(const QuantizedMesh& mesh);

// What the header says, read without decoding (the checksum is verified, limits are not).
struct StreamInfo {
  int version = 0;
  uint32_t n_vertices = 0, n_faces = 0, n_corners = 0;
  uint32_t n_materials = 0;  // highest material number + 1; 0 without faces
  int position_bits = 0;
  float origin[3] = {0, 0, 0};
  float step[3] = {1, 1, 1};
  int normal_bits = 0, texcoord_bits = 0;  // 0: none
  int face_bits = 0, face_components = 0;  // 0: faces have no values
  uint32_t n_points = 0;                   // distinct positions of the vertices that faces use
  bool constant_color = false;             // all vertices share one color
  bool keeps_order = false;
  EncodedSize size;
};
Result<StreamInfo> read_info(std::span<const uint8_t> bytes);

}  // namespace pac::geomcodec
