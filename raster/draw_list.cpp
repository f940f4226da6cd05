#include "raster/draw_list.h"

#include <algorithm>

#include "raster/corner_attributes.h"

namespace pac::raster {
namespace {

// A triangle that survived the trivial rejections, with what its face contributes.
struct Candidate {
  const Surface* surfaces[2];
  const Vertex* vertices[3];
  const Vertex* first;
  FaceNormal normal;
  uint32_t id;
  const float* previous[3];  // clip coordinates in the previous frame, if wanted
};

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

// Calls visit(tile) for each tile that the triangle may touch.
template <class Visit>
void for_each_tile(const RasterTriangle& t, int tiles_x, const SampleHull& hull, Visit&& visit) {
  const int x0 = t.min_x / kTileSize, x1 = t.max_x / kTileSize, y0 = t.min_y / kTileSize, y1 = t.max_y / kTileSize;
  const bool test = x1 - x0 + y1 - y0 > 1;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      if (!test || may_touch(t, x, y, hull)) visit(y * tiles_x + x);
}

// Stores one rendering's attributes with the triangle. `front` exchanges corners 1 and 2, as setup_triangle did.
void attach_attributes(const FrameInput& input, const Candidate& candidate, const ClipVertex* const corners[3],
                       bool front, Arena<float>& arena, RasterTriangle& triangle) {
  const float* weights[3] = {corners[0]->weight, corners[front ? 2 : 1]->weight, corners[front ? 1 : 2]->weight};
  for (int r = 0; r < 2; ++r) {
    if (candidate.surfaces[r] == nullptr) continue;
    const Surface& surface = *candidate.surfaces[r];
    CornerAttributes attributes;
    corner_attributes(surface, input.kernels->tile, candidate.normal, candidate.vertices, *candidate.first, front,
                      attributes);
    float* record = arena.allocate(3 * static_cast<size_t>(surface.layout.count));
    write_record(attributes, weights, surface.layout.count, record);
    triangle.attributes[r] = record;
    triangle.state[r] = surface.batch;
  }
  if (input.previous_clip == nullptr) return;
  CornerAttributes previous;
  for (int i = 0; i < 3; ++i) std::copy_n(candidate.previous[i], 4, previous.value[i]);
  float* record = arena.allocate(3 * 4);
  write_record(previous, weights, 4, record);
  triangle.attributes[2] = record;
}

}  // namespace

void DrawList::transform(const FrameInput& input, ThreadPool& pool) {
  const std::vector<Vertex>& source = input.mesh->vertices;
  if (vertices_.size() < source.size()) vertices_.resize(source.size());
  constexpr size_t kRange = 4096;
  const size_t ranges = (source.size() + kRange - 1) / kRange;
  pool.for_each(static_cast<int64_t>(ranges), [&](int64_t range) {
    const size_t first = static_cast<size_t>(range) * kRange, last = std::min(first + kRange, source.size());
    for (size_t i = first; i < last; ++i)
      vertices_[i] = transform_vertex(input.camera->clip_from_world, input.viewport, source[i].position);
  });
}

Result<RenderStats> DrawList::build(const FrameInput& input, ThreadPool& pool) {
  tiles_x_ = (input.viewport.width + kTileSize - 1) / kTileSize;
  tiles_y_ = (input.viewport.height + kTileSize - 1) / kTileSize;
  transform(input, pool);

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
  chunk.list.clear();
  chunk.pairs.clear();
  chunk.stats = {};
  chunk.result = {};
  for (size_t i = first_face; i < last_face && chunk.result.ok(); ++i)
    process_face(input, static_cast<uint32_t>(i), chunk);
  fill_bins(chunk);
}

void DrawList::process_face(const FrameInput& input, uint32_t face_number, Chunk& chunk) {
  const Mesh& mesh = *input.mesh;
  chunk.result = check_face(mesh, face_number, input.scene->materials.size());
  if (!chunk.result.ok()) return;
  const Face& face = mesh.faces[face_number];
  const uint32_t* indices = mesh.indices.data() + face.first;
  if (face.count == 3) {
    process_triangle(input, face_number, indices, chunk);
    return;
  }
  for (const CornerTriple& triple : chunk.cutter.cut(mesh, face)) {
    const uint32_t vertices[3] = {indices[triple.corner[0]], indices[triple.corner[1]], indices[triple.corner[2]]};
    process_triangle(input, face_number, vertices, chunk);
  }
}

void DrawList::process_triangle(const FrameInput& input, uint32_t face_number, const uint32_t vertices[3],
                                Chunk& chunk) {
  ++chunk.stats.triangles_submitted;
  const TransformedVertex* corners[3] = {&vertices_[vertices[0]], &vertices_[vertices[1]], &vertices_[vertices[2]]};
  const uint32_t any = corners[0]->outcode | corners[1]->outcode | corners[2]->outcode;
  const uint32_t all = corners[0]->outcode & corners[1]->outcode & corners[2]->outcode;
  if ((any & kNotFinite) != 0) {
    ++chunk.stats.triangles_dropped;
    return;
  }
  if ((all & kOutView) != 0) return;

  ClipVertex polygon[kMaxClipVertices];
  ScreenVertex screen[kMaxClipVertices];
  int n = 3;
  if ((any & kOutClip) != 0) {
    n = clip_triangle(corners, any & kOutClip, input.viewport, polygon);
    for (int i = 0; i < n; ++i) {
      if (project_vertex(polygon[i], input.viewport, screen[i])) continue;
      ++chunk.stats.triangles_dropped;
      return;
    }
  } else {
    for (int i = 0; i < 3; ++i) {
      polygon[i] = {0, 0, 0, 0, {i == 0 ? 1.0f : 0.0f, i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f}};
      screen[i] = corners[i]->screen;
    }
  }
  const Mesh& mesh = *input.mesh;
  const Face& face = mesh.faces[face_number];
  Candidate candidate{{nullptr, nullptr},
                      {&mesh.vertices[vertices[0]], &mesh.vertices[vertices[1]], &mesh.vertices[vertices[2]]},
                      &mesh.vertices[mesh.indices[face.first]],
                      {0, 0, 0},
                      face_number + 1,
                      {nullptr, nullptr, nullptr}};
  if (input.previous_clip != nullptr)
    for (int i = 0; i < 3; ++i) candidate.previous[i] = input.previous_clip + 4 * size_t{vertices[i]};
  bool needs_normal = false;
  for (int r = 0; r < 2; ++r) {
    if (input.surfaces[r] == nullptr) continue;
    candidate.surfaces[r] = &(*input.surfaces[r])[face.material];
    needs_normal |= candidate.surfaces[r]->lit != Surface::Lit::no;
  }
  bool has_normal = false;
  uint64_t drawn = 0, degenerate = 0;
  for (int i = 1; i + 1 < n; ++i) {
    const ScreenVertex triangle_corners[3] = {screen[0], screen[i], screen[i + 1]};
    RasterTriangle triangle;
    const SetupResult result = setup_triangle(triangle_corners, input.viewport, input.hull, triangle);
    degenerate += result == SetupResult::degenerate ? 1 : 0;
    if (result == SetupResult::degenerate || result == SetupResult::missed) continue;
    const bool front = result == SetupResult::front;
    if (!front && candidate.surfaces[0]->drop_back_faces) continue;
    if (needs_normal && !has_normal) {
      candidate.normal = face_normal(mesh, face);
      has_normal = true;
    }
    RasterTriangle* const stored = chunk.triangles.allocate(1);
    *stored = triangle;
    stored->id = candidate.id;
    stored->attributes[0] = stored->attributes[1] = stored->attributes[2] = nullptr;
    stored->state[0] = stored->state[1] = 0;
    const ClipVertex* const clip_corners[3] = {&polygon[0], &polygon[i], &polygon[i + 1]};
    attach_attributes(input, candidate, clip_corners, front, chunk.attributes, *stored);
    chunk.list.push_back(stored);
    ++drawn;
  }
  chunk.stats.triangles_drawn += drawn;
  if (drawn == 0 && degenerate > 0) ++chunk.stats.triangles_dropped;
  for (size_t i = chunk.list.size() - drawn; i < chunk.list.size(); ++i)
    for_each_tile(*chunk.list[i], tiles_x_, input.hull, [&](int tile) {
      chunk.pairs.push_back({static_cast<uint32_t>(tile), chunk.list[i]});
    });
}

// Counting sort of the (tile, triangle) pairs by tile; stable, so the order of the scene stays.
void DrawList::fill_bins(Chunk& chunk) const {
  const size_t n_tiles = static_cast<size_t>(tiles_x_) * static_cast<size_t>(tiles_y_);
  chunk.bin_start.assign(n_tiles + 2, 0);
  for (const TilePair& pair : chunk.pairs) ++chunk.bin_start[pair.tile + 2];
  for (size_t i = 2; i < n_tiles + 2; ++i) chunk.bin_start[i] += chunk.bin_start[i - 1];
  chunk.bins.resize(chunk.pairs.size());
  for (const TilePair& pair : chunk.pairs) chunk.bins[chunk.bin_start[pair.tile + 1]++] = pair.triangle;
}

void DrawList::triangles_of(int tile, std::vector<const RasterTriangle*>& out) const {
  out.clear();
  const auto t = static_cast<size_t>(tile);
  for (size_t c = 0; c < n_chunks_; ++c) {
    const Chunk& chunk = chunks_[c];
    out.insert(out.end(), chunk.bins.begin() + chunk.bin_start[t], chunk.bins.begin() + chunk.bin_start[t + 1]);
  }
}

}  // namespace pac::raster
