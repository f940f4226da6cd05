#include "raster/draw_list.h"

#include <algorithm>

namespace pac::raster {
namespace {

// The face is inside the index list and its indices and material inside theirs.
Result<void> check_face(const Mesh& mesh, uint32_t number, size_t n_materials) {
  const Face& face = mesh.faces[number];
  if (face.count < 3) return Failure{Error::corrupt, number, "face with fewer than three corners"};
  if (face.first > mesh.indices.size() || face.count > mesh.indices.size() - face.first)
    return Failure{Error::corrupt, number, "face reaches outside the index list"};
  if (face.material >= n_materials) return Failure{Error::corrupt, number, "face names a material that does not exist"};
  for (uint32_t i = 0; i < face.count; ++i)
    if (mesh.indices[face.first + i] >= mesh.vertices.size())
      return Failure{Error::corrupt, number, "face names a vertex that does not exist"};
  return {};
}

// Whether check_face() finds nothing; without the cost of a Result a face.
bool is_valid(const Mesh& mesh, const Face& face, size_t n_materials) {
  if (face.count < 3 || face.material >= n_materials || face.first > mesh.indices.size() ||
      face.count > mesh.indices.size() - face.first)
    return false;
  const uint32_t* const indices = mesh.indices.data() + face.first;
  const size_t n_vertices = mesh.vertices.size();
  bool inside = true;
  for (uint32_t i = 0; i < face.count; ++i) inside = inside && indices[i] < n_vertices;
  return inside;
}

// Some sample of the tile may be inside: each edge function is >= 0 at the tile's most favorable sample position.
bool may_touch(const RasterTriangle& t, int tile_x, int tile_y, const SampleHull& hull) {
  const int64_t left = int64_t{tile_x} * kTileSize * 256 + hull.min_x - t.x0;
  const int64_t right = int64_t{tile_x} * kTileSize * 256 + (kTileSize - 1) * 256 + hull.max_x - t.x0;
  const int64_t top = int64_t{tile_y} * kTileSize * 256 + hull.min_y - t.y0;
  const int64_t bottom = int64_t{tile_y} * kTileSize * 256 + (kTileSize - 1) * 256 + hull.max_y - t.y0;
  for (int i = 0; i < 3; ++i) {
    const int64_t best =
        (i == 0 ? t.area2 : 0) + t.a[i] * (t.a[i] > 0 ? right : left) + t.b[i] * (t.b[i] > 0 ? bottom : top);
    if (best < t.exclude[i]) return false;
  }
  return true;
}

constexpr size_t kTrianglesAhead = 16;  // of those being set up, memory is asked for

// Bits of a mask of eight; base code may not count on the instruction for it.
size_t count_lanes(uint32_t mask) {
  constexpr uint64_t kOfFour = 0x4332322132212110;
  return (kOfFour >> 4 * (mask & 15) & 15) + (kOfFour >> 4 * (mask >> 4) & 15);
}

// Calls visit(tile) for each tile that the triangle may touch.
template <class Visit>
void for_each_tile(const RasterTriangle& t, int tiles_x, const SampleHull& hull, Visit&& visit) {
  constexpr int kShift = 5;
  static_assert(1 << kShift == kTileSize);
  const int x0 = t.min_x >> kShift, x1 = t.max_x >> kShift, y0 = t.min_y >> kShift, y1 = t.max_y >> kShift;
  if (x0 == x1 && y0 == y1) return visit(y0 * tiles_x + x0);
  const bool test = x1 - x0 + y1 - y0 > 1;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      if (!test || may_touch(t, x, y, hull)) visit(y * tiles_x + x);
}

// Clockwise on the screen and not degenerate: setup_triangle() would say `back`, or that it is missed.
bool is_back(const ScreenVertex& v0, const ScreenVertex& v1, const ScreenVertex& v2) {
  return static_cast<int64_t>(v1.x - v0.x) * (v2.y - v0.y) > static_cast<int64_t>(v2.x - v0.x) * (v1.y - v0.y);
}

}  // namespace

void DrawList::transform(const FrameInput& input, ThreadPool& pool) {
  const std::vector<Vertex>& source = input.mesh->vertices;
  if (screen_.size() < source.size()) {
    screen_.resize(source.size());
    outcodes_.resize(source.size());
  }
  transform_ = screen_transform(input.camera->clip_from_world, input.viewport);
  rules_ = setup_rules(input.viewport, input.hull);
  static_assert(sizeof(Vertex) % sizeof(float) == 0 && sizeof(Vertex::position) + sizeof(Vertex::normal) >= 16);
  constexpr size_t kRange = 4096;
  const size_t ranges = (source.size() + kRange - 1) / kRange;
  pool.for_each(static_cast<int64_t>(ranges), [&](int64_t range) {
    const size_t first = static_cast<size_t>(range) * kRange, last = std::min(first + kRange, source.size());
    input.kernels->front.transform_vertices(transform_, source[first].position, sizeof(Vertex) / sizeof(float),
                                            static_cast<int>(last - first), &screen_[first], &outcodes_[first]);
  });
}

Result<RenderStats> DrawList::build(const FrameInput& input, ThreadPool& pool) {
  tiles_x_ = (input.viewport.width + kTileSize - 1) / kTileSize;
  tiles_y_ = (input.viewport.height + kTileSize - 1) / kTileSize;
  transform(input, pool);
  for (int r = 0; r < 2; ++r)
    if (input.surfaces[r] != nullptr && input.wants_attributes)
      lit_[r].prepare(*input.mesh, *input.surfaces[r], *input.kernels, outcodes_.data(), pool);

  // Chunks only divide the work: triangles keep the order of the scene whatever their number.
  const size_t n_faces = input.mesh->faces.size();
  const auto n_threads = static_cast<size_t>(pool.thread_count());
  n_chunks_ = n_threads == 1 ? 1 : std::min<size_t>(4 * n_threads, n_faces / 256 + 1);
  if (chunks_.size() < n_chunks_) chunks_.resize(n_chunks_);
  pool.for_each(static_cast<int64_t>(n_chunks_), [&](int64_t i) {
    const auto c = static_cast<size_t>(i);
    process(input, n_faces * c / n_chunks_, n_faces * (c + 1) / n_chunks_, chunks_[c]);
  });

  RenderStats total;
  for (size_t c = 0; c < n_chunks_; ++c) {
    PAC_CHECK(chunks_[c].result);
    total.triangles_submitted += chunks_[c].stats.triangles_submitted;
    total.triangles_drawn += chunks_[c].stats.triangles_drawn;
    total.triangles_dropped += chunks_[c].stats.triangles_dropped;
  }
  return total;
}

void DrawList::process(const FrameInput& input, size_t first_face, size_t last_face, Chunk& chunk) {
  chunk.triangles.reset();
  chunk.attributes.reset();
  chunk.tiles.reset(static_cast<size_t>(tiles_x_) * static_cast<size_t>(tiles_y_));
  chunk.n_pending = 0;
  chunk.drop_back = chunk.whole = 0;
  chunk.normal_of = UINT32_MAX;
  chunk.stats = {};
  chunk.result = {};
  const Mesh& mesh = *input.mesh;
  const size_t n_materials = input.scene->materials.size();
  for (size_t i = append_plain(input, first_face, last_face, chunk); i < last_face;
       i = append_plain(input, i + 1, last_face, chunk)) {
    const auto number = static_cast<uint32_t>(i);
    const Face& face = mesh.faces[i];
    if (!is_valid(mesh, face, n_materials)) {
      chunk.result = check_face(mesh, number, n_materials);
      break;
    }
    if (face.count == 3)
      process_triangle(input, number, mesh.indices.data() + face.first, chunk);
    else
      process_polygon(input, number, chunk);
  }
  flush(input, chunk);
}

// What process() does for valid triangles without corners beyond the clipping planes, which is most of them, from
// `face` on; the first face that is none.
size_t DrawList::append_plain(const FrameInput& input, size_t face, size_t last_face, Chunk& chunk) const {
  const Mesh& mesh = *input.mesh;
  const size_t n_materials = input.scene->materials.size(), n_vertices = mesh.vertices.size(), given = face;
  if (mesh.indices.size() < 3) return face;
  const size_t last_first = mesh.indices.size() - 3;
  const Face* const faces = mesh.faces.data();
  const uint32_t *const indices = mesh.indices.data(), *const outcodes = outcodes_.data();
  const std::vector<Surface>& surfaces = *input.surfaces[0];
  uint32_t material = UINT32_MAX, drop_back = 0, dropped = chunk.drop_back, whole = chunk.whole;
  int n = chunk.n_pending;
  for (; face < last_face; ++face) {
    const Face& at = faces[face];
    if (at.count != 3 || at.material >= n_materials || at.first > last_first) break;
    const uint32_t v0 = indices[at.first], v1 = indices[at.first + 1], v2 = indices[at.first + 2];
    if (v0 >= n_vertices || v1 >= n_vertices || v2 >= n_vertices) break;
    const uint32_t any = outcodes[v0] | outcodes[v1] | outcodes[v2], all = outcodes[v0] & outcodes[v1] & outcodes[v2];
    if ((any & kNotFinite) != 0) break;
    if ((all & kOutView) != 0) continue;
    if ((any & kOutClip) != 0) break;
    if (at.material != material) drop_back = surfaces[at.material].drop_back_faces ? 1 : 0;
    material = at.material;
    chunk.pending[n] = {{v0, v1, v2}, static_cast<uint32_t>(face), material};
    dropped |= drop_back << n;
    whole |= 1u << n;
    if (++n < kSetupLanes) continue;
    chunk.n_pending = n;
    chunk.drop_back = dropped;
    chunk.whole = whole;
    flush(input, chunk);
    n = 0;
    dropped = whole = 0;
  }
  chunk.n_pending = n;
  chunk.drop_back = dropped;
  chunk.whole = whole;
  chunk.stats.triangles_submitted += face - given;
  return face;
}

void DrawList::process_polygon(const FrameInput& input, uint32_t face_number, Chunk& chunk) {
  const Mesh& mesh = *input.mesh;
  const Face& face = mesh.faces[face_number];
  const uint32_t* indices = mesh.indices.data() + face.first;
  if (is_unseen(face, indices, (*input.surfaces[0])[face.material].drop_back_faces)) {
    chunk.stats.triangles_submitted += face.count - 2;
    return;
  }
  for (const CornerTriple& triple : chunk.cutter.cut(mesh, face)) {
    const uint32_t vertices[3] = {indices[triple.corner[0]], indices[triple.corner[1]], indices[triple.corner[2]]};
    process_triangle(input, face_number, vertices, chunk);
  }
}

// No triangle of the polygon, however it is cut, will be drawn: all corners are beyond one side of the view, or it is
// a quadrilateral whose corners, taken three at a time in any way, are clockwise on the screen.
bool DrawList::is_unseen(const Face& face, const uint32_t* indices, bool drop_back_faces) const {
  uint32_t any = 0, all = ~0u;
  for (uint32_t k = 0; k < face.count; ++k) {
    any |= outcodes_[indices[k]];
    all &= outcodes_[indices[k]];
  }
  if ((any & kNotFinite) != 0) return false;
  if ((all & kOutView) != 0) return true;
  if (face.count != 4 || !drop_back_faces || (any & kOutClip) != 0) return false;
  const auto corner = [&](int k) -> const ScreenVertex& { return screen_[indices[k]]; };
  return is_back(corner(0), corner(1), corner(2)) && is_back(corner(0), corner(2), corner(3)) &&
         is_back(corner(0), corner(1), corner(3)) && is_back(corner(1), corner(2), corner(3));
}

// Trivial rejections. What needs no clipping waits until there is a group; groups and clipped triangles keep the order
// of the scene.
inline void DrawList::process_triangle(const FrameInput& input, uint32_t face_number, const uint32_t vertices[3],
                                       Chunk& chunk) {
  ++chunk.stats.triangles_submitted;
  const uint32_t codes[3] = {outcodes_[vertices[0]], outcodes_[vertices[1]], outcodes_[vertices[2]]};
  const uint32_t any = codes[0] | codes[1] | codes[2], all = codes[0] & codes[1] & codes[2];
  if ((any & kNotFinite) != 0) {
    ++chunk.stats.triangles_dropped;
    return;
  }
  if ((all & kOutView) != 0) return;
  const Face& face = input.mesh->faces[face_number];
  const MeshTriangle triangle{{vertices[0], vertices[1], vertices[2]}, face_number, face.material};
  if ((any & kOutClip) != 0) {
    flush(input, chunk);
    process_clipped(input, triangle, any & kOutClip, chunk);
    return;
  }
  const int lane = chunk.n_pending++;
  chunk.pending[lane] = triangle;
  const bool drop_back_faces = (*input.surfaces[0])[face.material].drop_back_faces;
  chunk.drop_back |= (drop_back_faces ? 1u : 0u) << lane;
  chunk.whole |= (face.count == 3 ? 1u : 0u) << lane;
  if (chunk.n_pending == kSetupLanes) flush(input, chunk);
}

// Sets up the triangles that wait.
void DrawList::flush(const FrameInput& input, Chunk& chunk) const {
  const int n = chunk.n_pending;
  if (n == 0) return;
  RasterTriangle* stored = chunk.triangles.allocate(kSetupLanes);
  SetupMasks masks;
  input.kernels->front.setup_triangles(rules_, n, chunk.pending, screen_.data(), chunk.drop_back, stored, masks);
  const auto n_drawn = count_lanes(masks.drawn);
  chunk.triangles.release(kSetupLanes - n_drawn);
  // Where later groups go has left the caches since the last frame, if there are many: their stores would wait for it.
  static_assert(kTrianglesAhead <= Arena<RasterTriangle>::kReadable);
  for (size_t i = 0; i < n_drawn; ++i) {
    const auto* const later = reinterpret_cast<const char*>(stored + kTrianglesAhead + i);
    __builtin_prefetch(later, 1);
    __builtin_prefetch(later + 64, 1);
  }
  chunk.stats.triangles_dropped += count_lanes(masks.degenerate);
  if (n_drawn > 0) attach(input, masks, stored, chunk);
  chunk.n_pending = 0;
  chunk.drop_back = chunk.whole = 0;
}

void DrawList::process_clipped(const FrameInput& input, const MeshTriangle& triangle, uint32_t planes, Chunk& chunk) {
  const Mesh& mesh = *input.mesh;
  TransformedVertex vertices[3];
  const TransformedVertex* corners[3];
  for (int i = 0; i < 3; ++i) {
    vertices[i] = transform_vertex(transform_, mesh.vertices[triangle.vertices[i]].position);
    corners[i] = &vertices[i];
  }
  ClipVertex polygon[kMaxClipVertices];
  ScreenVertex screen[kMaxClipVertices];
  const int n = clip_triangle(corners, planes, input.viewport, polygon);
  for (int i = 0; i < n; ++i) {
    if (project_vertex(polygon[i], transform_, screen[i])) continue;
    ++chunk.stats.triangles_dropped;
    return;
  }
  const bool drop_back_faces = (*input.surfaces[0])[mesh.faces[triangle.face].material].drop_back_faces;
  Candidate candidate{};
  uint64_t drawn = 0, degenerate = 0;
  for (int i = 1; i + 1 < n; ++i) {
    const ScreenVertex triangle_corners[3] = {screen[0], screen[i], screen[i + 1]};
    RasterTriangle* const stored = chunk.triangles.allocate(1);
    const SetupResult result = setup_triangle(triangle_corners, input.viewport, input.hull, *stored);
    degenerate += result == SetupResult::degenerate ? 1 : 0;
    const bool front = result == SetupResult::front;
    if (result == SetupResult::degenerate || result == SetupResult::missed || (!front && drop_back_faces)) {
      chunk.triangles.release(1);
      continue;
    }
    if (drawn++ == 0) fill_candidate(input, triangle.face, triangle.vertices, chunk, candidate);
    const ClipVertex* const clip_corners[3] = {&polygon[0], &polygon[i], &polygon[i + 1]};
    store(input, candidate, clip_corners, front, chunk, *stored);
  }
  if (drawn == 0 && degenerate > 0) ++chunk.stats.triangles_dropped;
}

void DrawList::list_in_tiles(const FrameInput& input, const RasterTriangle& triangle, Chunk& chunk) const {
  for_each_tile(triangle, tiles_x_, input.hull,
                [&](int tile) { chunk.tiles.append(static_cast<size_t>(tile), &triangle); });
  ++chunk.stats.triangles_drawn;
}

void DrawList::triangles_of(int tile, std::vector<const RasterTriangle*>& out) const {
  out.clear();
  for (size_t c = 0; c < n_chunks_; ++c) chunks_[c].tiles.copy(static_cast<size_t>(tile), out);
}

}  // namespace pac::raster
