// What a triangle of the list carries for the shading: ids, states and records of attributes.
#include <algorithm>
#include <bit>
#include <cstddef>

#include "raster/corner_attributes.h"
#include "raster/draw_list.h"

namespace pac::raster {
namespace {

// Records of unlit surfaces without other attributes, from the vertices in the order of RasterTriangle's corners.
inline void write_color_record(const Surface& surface, const Vertex* const vertices[3], float record[9]) {
  const uint8_t* const colors[3] = {vertices[0]->color, vertices[1]->color, vertices[2]->color};
  for (int c = 0; c < 3; ++c) {
    const float a0 = static_cast<float>(colors[0][c]) * surface.mean[c];
    record[3 * c] = a0;
    record[3 * c + 1] = static_cast<float>(colors[1][c]) * surface.mean[c] - a0;
    record[3 * c + 2] = static_cast<float>(colors[2][c]) * surface.mean[c] - a0;
  }
}

// Of surfaces lit at corners, from what light_points() gave.
inline void write_lit_record(const float* corner0, const float* corner1, const float* corner2, float record[9]) {
  for (int c = 0; c < 3; ++c) {
    const float a0 = corner0[c];
    record[3 * c] = a0;
    record[3 * c + 1] = corner1[c] - a0;
    record[3 * c + 2] = corner2[c] - a0;
  }
}

// Stores the renderings' attributes with the triangle. `front` exchanges corners 1 and 2, as setup_triangle did.
// corners: null for a triangle that was not clipped.
void attach_attributes(const FrameInput& input, const Candidate& candidate, const ClipVertex* const* corners,
                       bool front, Arena<float>& arena, RasterTriangle& triangle) {
  const int order[3] = {0, front ? 2 : 1, front ? 1 : 2};
  const auto write = [&](const CornerAttributes& attributes, int count) {
    float* record = arena.allocate(3 * static_cast<size_t>(count));
    if (corners == nullptr) {
      write_whole_record(attributes, order, count, record);
    } else {
      const float* const weights[3] = {corners[order[0]]->weight, corners[order[1]]->weight, corners[order[2]]->weight};
      write_record(attributes, weights, count, record);
    }
    return record;
  };
  for (int r = 0; r < 2; ++r) {
    if (candidate.surfaces[r] == nullptr) continue;
    const Surface& surface = *candidate.surfaces[r];
    triangle.state[r] = surface.batch;
    if (!input.wants_attributes) continue;
    if (corners == nullptr && surface.lit == Surface::Lit::no && surface.layout.count == 3) {
      float* record = arena.allocate(9);
      const Vertex* const vertices[3] = {candidate.vertices[0], candidate.vertices[order[1]],
                                         candidate.vertices[order[2]]};
      write_color_record(surface, vertices, record);
      triangle.attributes[r] = record;
      continue;
    }
    CornerAttributes attributes;
    corner_attributes(surface, input.kernels->tile, candidate.normal, candidate.vertices, candidate.lit[r],
                      *candidate.first, front, attributes);
    triangle.attributes[r] = write(attributes, surface.layout.count);
  }
  if (input.previous_clip == nullptr) return;
  CornerAttributes previous;
  for (int i = 0; i < 3; ++i) std::copy_n(candidate.previous[i], 4, previous.value[i]);
  triangle.attributes[2] = write(previous, 4);
}

}  // namespace

void DrawList::fill_candidate(const FrameInput& input, uint32_t face_number, const uint32_t vertices[3], Chunk& chunk,
                              Candidate& out) const {
  const Mesh& mesh = *input.mesh;
  const Face& face = mesh.faces[face_number];
  out.first = &mesh.vertices[mesh.indices[face.first]];
  out.id = face_number + 1;
  out.normal = {0, 0, 0};
  for (int i = 0; i < 3; ++i) out.vertices[i] = &mesh.vertices[vertices[i]];
  for (int r = 0; r < 2; ++r) {
    out.surfaces[r] = nullptr;
    if (input.surfaces[r] == nullptr) continue;
    out.surfaces[r] = &(*input.surfaces[r])[face.material];
    if (!input.wants_attributes) continue;
    if (out.surfaces[r]->lit != Surface::Lit::no) out.normal = normal_of(mesh, face_number, chunk);
    for (int i = 0; i < 3; ++i) out.lit[r][i] = lit_[r].find(vertices[i], face.material);
  }
  for (int i = 0; i < 3; ++i)
    out.previous[i] = input.previous_clip != nullptr ? input.previous_clip + 4 * size_t{vertices[i]} : nullptr;
}

const FaceNormal& DrawList::normal_of(const Mesh& mesh, uint32_t face_number, Chunk& chunk) const {
  if (chunk.normal_of != face_number) {
    chunk.normal = face_normal(mesh, mesh.faces[face_number]);
    chunk.normal_of = face_number;
  }
  return chunk.normal;
}

// Bit k: own normals light all corners of the k-th triangle of those that wait, if it is drawn, as corner_attributes()
// would find with the normal of the face, which the triangle is alone. Bits that are 0 say nothing.
uint32_t DrawList::kept_normals(const FrameInput& input, const SetupMasks& masks, const Chunk& chunk) {
  if (!input.wants_attributes || !input.wants_normals || input.previous_clip != nullptr) return 0;
  static_assert(offsetof(Vertex, normal) == 3 * sizeof(float) && sizeof(Vertex) >= 8 * sizeof(float));
  return input.kernels->front.keeps_normals(masks.drawn & chunk.whole, chunk.pending,
                                            input.mesh->vertices.data()->position, sizeof(Vertex) / sizeof(float),
                                            masks.front);
}

// The attributes of a triangle in one rendering, or null where attach_attributes() is needed for them.
inline const float* DrawList::plain_record(const FrameInput& input, int rendering, const MeshTriangle& pending,
                                           uint32_t front, bool keeps_normals, Arena<float>& arena) const {
  const Surface& surface = (*input.surfaces[rendering])[pending.material];
  const bool colors_alone = surface.layout.count == 3;
  const bool by_sample = surface.lit == Surface::Lit::per_sample && surface.layout.count == 9 &&
                         surface.layout.normal == 3 && surface.layout.position == 6;
  if (!colors_alone && !by_sample) return nullptr;
  const bool is_lit = surface.lit != Surface::Lit::no;
  if (is_lit && !keeps_normals) return nullptr;
  const uint32_t corner0 = pending.vertices[0], corner1 = pending.vertices[1 + front],
                 corner2 = pending.vertices[2 - front];
  if (is_lit && colors_alone) {
    const LitVertices& colors = lit_[rendering];
    const float *const lit0 = colors.find(corner0, pending.material),
                       *const lit1 = colors.find(corner1, pending.material),
                       *const lit2 = colors.find(corner2, pending.material);
    if (lit0 == nullptr || lit1 == nullptr || lit2 == nullptr) return nullptr;
    float* const record = arena.allocate(9);
    write_lit_record(lit0, lit1, lit2, record);
    return record;
  }
  const Vertex* const first = input.mesh->vertices.data();
  const Vertex* const vertices[3] = {first + corner0, first + corner1, first + corner2};
  if (is_lit) {
    float* const record = arena.allocate(27);
    return write_normal_record(vertices, record) ? record : nullptr;
  }
  float* const record = arena.allocate(9);
  write_color_record(surface, vertices, record);
  return record;
}

// What store() would do for a triangle that is not clipped, where that takes neither a face's normal nor lighting.
// False: it does, and the triangle is not complete.
inline bool DrawList::attach_plain(const FrameInput& input, const MeshTriangle& pending, uint32_t front,
                                   bool keeps_normals, Arena<float>& arena, RasterTriangle& triangle) const {
  if (input.previous_clip != nullptr) return false;
  triangle.id = pending.face + 1;
  for (int r = 0; r < 2; ++r) {
    const bool drawn = input.surfaces[r] != nullptr;
    triangle.state[r] = drawn ? (*input.surfaces[r])[pending.material].batch : 0;
    triangle.attributes[r] = nullptr;
    if (!drawn || !input.wants_attributes) continue;
    triangle.attributes[r] = plain_record(input, r, pending, front, keeps_normals, arena);
    if (triangle.attributes[r] == nullptr) return false;
  }
  triangle.attributes[2] = nullptr;
  return true;
}

// What attach() does for drawn triangles of one material whose records hold colors alone, in one rendering, those of
// corners lit before if at all. False: they are not that, and nothing is done.
bool DrawList::attach_colors(const FrameInput& input, const SetupMasks& masks, uint32_t kept, RasterTriangle* stored,
                             Chunk& chunk) const {
  if (input.previous_clip != nullptr || input.surfaces[1] != nullptr || !input.wants_attributes) return false;
  const uint32_t material = chunk.pending[std::countr_zero(masks.drawn)].material;
  const Surface& surface = (*input.surfaces[0])[material];
  const bool is_lit = surface.lit != Surface::Lit::no;
  if (surface.layout.count != 3 || (is_lit && kept != masks.drawn)) return false;
  CornerNumbers corners;
  uint32_t faces[kSetupLanes];
  int n = 0;
  bool alike = true;
  for (uint32_t left = masks.drawn; left != 0; left &= left - 1, ++n) {
    const int lane = std::countr_zero(left);
    const MeshTriangle& triangle = chunk.pending[lane];
    const uint32_t front = masks.front >> lane & 1;
    alike = alike && triangle.material == material;
    corners[0][n] = triangle.vertices[0];
    corners[1][n] = triangle.vertices[1 + front];
    corners[2][n] = triangle.vertices[2 - front];
    faces[n] = triangle.face;
  }
  if (!alike) return false;
  const LitVertices& lit = lit_[0];
  if (is_lit)
    for (int k = 0; k < n; ++k)
      if (!lit.has(corners[0][k], material) || !lit.has(corners[1][k], material) || !lit.has(corners[2][k], material))
        return false;
  for (int k = n; k < kSetupLanes; ++k)
    for (auto& corner : corners) corner[k] = corner[0];
  float* record = chunk.attributes.allocate(9 * static_cast<size_t>(n));
  if (is_lit)
    input.kernels->front.lit_records(n, corners, lit.colors(), lit.stride(), record);
  else
    input.kernels->front.color_records(n, corners, input.mesh->vertices.data()->position,
                                       sizeof(Vertex) / sizeof(float), surface.mean, record);
  for (int k = 0; k < n; ++k, record += 9) {
    RasterTriangle& triangle = *stored++;
    triangle.id = faces[k] + 1;
    triangle.state[0] = surface.batch;
    triangle.state[1] = 0;
    triangle.attributes[0] = record;
    triangle.attributes[1] = triangle.attributes[2] = nullptr;
    list_in_tiles(input, triangle, chunk);
  }
  return true;
}

// Attributes of the drawn triangles of those that wait, and their tiles.
void DrawList::attach(const FrameInput& input, const SetupMasks& masks, RasterTriangle* stored, Chunk& chunk) const {
  Candidate candidate;
  const uint32_t kept = kept_normals(input, masks, chunk);
  if (attach_colors(input, masks, kept, stored, chunk)) return;
  for (uint32_t left = masks.drawn; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const MeshTriangle& triangle = chunk.pending[lane];
    const uint32_t front = masks.front >> lane & 1;
    if (attach_plain(input, triangle, front, (kept >> lane & 1) != 0, chunk.attributes, *stored)) {
      list_in_tiles(input, *stored++, chunk);
    } else {
      fill_candidate(input, triangle.face, triangle.vertices, chunk, candidate);
      store(input, candidate, nullptr, front != 0, chunk, *stored++);
    }
  }
}

// Completes a triangle that is set up and lists it in its tiles. corners: null for a triangle that was not clipped.
void DrawList::store(const FrameInput& input, const Candidate& candidate, const ClipVertex* const* corners, bool front,
                     Chunk& chunk, RasterTriangle& triangle) const {
  triangle.id = candidate.id;
  triangle.attributes[0] = triangle.attributes[1] = triangle.attributes[2] = nullptr;
  triangle.state[0] = triangle.state[1] = 0;
  attach_attributes(input, candidate, corners, front, chunk.attributes, triangle);
  list_in_tiles(input, triangle, chunk);
}

}  // namespace pac::raster
