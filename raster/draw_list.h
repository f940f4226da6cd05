// The front end: faces -> triangles -> clip -> setup -> corner attributes -> lists of triangles by tile.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "raster/clip.h"
#include "raster/lit_vertices.h"
#include "raster/renderer.h"
#include "raster/setup.h"
#include "raster/surface.h"
#include "raster/tile_lists.h"
#include "raster/triangulate.h"

namespace pac::raster {

// Memory for one frame in blocks that stay where they are and are kept for the next frame.
template <class T>
class Arena {
 public:
  static constexpr size_t kReadable = 16;
  // n <= kBlock elements, contiguous, uninitialized; kReadable more may be read.
  T* allocate(size_t n) {
    if (used_ + n > kBlock || block_ == 0) {
      if (block_ == blocks_.size()) blocks_.emplace_back(new T[kBlock + kReadable]);
      ++block_;
      used_ = 0;
    }
    T* const result = blocks_[block_ - 1].get() + used_;
    used_ += n;
    return result;
  }
  // Gives back the last n elements of the last allocation.
  void release(size_t n) { used_ -= n; }
  void reset() { block_ = used_ = 0; }

 private:
  static constexpr size_t kBlock = 4096;
  std::vector<std::unique_ptr<T[]>> blocks_;
  size_t block_ = 0, used_ = 0;  // blocks in use; elements in the last of them
};

// What the front end reads. `surfaces[1]` is null unless two renderings are drawn at once.
struct FrameInput {
  const Scene* scene;
  const Mesh* mesh;  // the scene's, posed
  const Camera* camera;
  const Kernels* kernels;
  Viewport viewport;
  SampleHull hull;
  const std::vector<Surface>* surfaces[2];
  const float* previous_clip;    // four a vertex, or null where nobody asks where things were
  bool wants_attributes = true;  // false: nothing is shaded, and attributes[0] and [1] stay null
  bool wants_normals = true;     // false: no surface is lit
};

// A triangle that survived the trivial rejections, with what its face contributes.
struct Candidate {
  const Surface* surfaces[2];
  const Vertex* vertices[3];
  const float* lit[2][3];  // colors of the vertices where they were lit before, or null
  const Vertex* first;
  FaceNormal normal;  // of the face, where something is lit
  uint32_t id;
  const float* previous[3];  // clip coordinates in the previous frame, if wanted
};

// The triangles of a frame in scene order, by tile. Rebuilt each frame; keeps its memory.
class DrawList {
 public:
  // Fails with corrupt where a face, index or material is out of range.
  Result<RenderStats> build(const FrameInput& input, ThreadPool& pool);

  int tiles_x() const { return tiles_x_; }
  int tiles_y() const { return tiles_y_; }
  // The triangles that may touch the tile, in scene order.
  void triangles_of(int tile, std::vector<const RasterTriangle*>& out) const;

 private:
  // A contiguous part of the faces, worked on by one thread.
  struct Chunk {
    Arena<RasterTriangle> triangles;
    Arena<float> attributes;
    MeshTriangle pending[kSetupLanes];  // wholly inside the clipping planes, waiting until there are eight
    uint32_t drop_back = 0;             // bit k: the back of pending[k] is not drawn
    uint32_t whole = 0;                 // bit k: pending[k] is its face
    int n_pending = 0;
    TileLists tiles;
    PolygonCutter cutter;
    uint32_t normal_of = UINT32_MAX;  // the face whose normal is in `normal`
    FaceNormal normal{};
    RenderStats stats;
    Result<void> result;
  };
  void transform(const FrameInput& input, ThreadPool& pool);
  void process(const FrameInput& input, size_t first_face, size_t last_face, Chunk& chunk);
  size_t append_plain(const FrameInput& input, size_t face, size_t last_face, Chunk& chunk) const;
  void process_polygon(const FrameInput& input, uint32_t face_number, Chunk& chunk);
  void process_triangle(const FrameInput& input, uint32_t face_number, const uint32_t vertices[3], Chunk& chunk);
  void process_clipped(const FrameInput& input, const MeshTriangle& triangle, uint32_t planes, Chunk& chunk);
  void flush(const FrameInput& input, Chunk& chunk) const;
  void attach(const FrameInput& input, const SetupMasks& masks, RasterTriangle* stored, Chunk& chunk) const;
  void store(const FrameInput& input, const Candidate& candidate, const ClipVertex* const* corners, bool front,
             Chunk& chunk, RasterTriangle& triangle) const;
  bool is_unseen(const Face& face, const uint32_t* indices, bool drop_back_faces) const;
  void fill_candidate(const FrameInput& input, uint32_t face_number, const uint32_t vertices[3], Chunk& chunk,
                      Candidate& out) const;
  static uint32_t kept_normals(const FrameInput& input, const SetupMasks& masks, const Chunk& chunk);
  bool attach_colors(const FrameInput& input, const SetupMasks& masks, uint32_t kept, RasterTriangle* stored,
                     Chunk& chunk) const;
  bool attach_plain(const FrameInput& input, const MeshTriangle& pending, uint32_t front, bool keeps_normals,
                    Arena<float>& arena, RasterTriangle& triangle) const;
  const float* plain_record(const FrameInput& input, int rendering, const MeshTriangle& pending, uint32_t front,
                            bool keeps_normals, Arena<float>& arena) const;
  void list_in_tiles(const FrameInput& input, const RasterTriangle& triangle, Chunk& chunk) const;

  const FaceNormal& normal_of(const Mesh& mesh, uint32_t face_number, Chunk& chunk) const;

  ScreenTransform transform_{};
  SetupRules rules_{};
  std::vector<ScreenVertex> screen_;  // a vertex
  std::vector<uint32_t> outcodes_;    // a vertex
  LitVertices lit_[2];                // per rendering
  std::vector<Chunk> chunks_;
  size_t n_chunks_ = 0;
  int tiles_x_ = 0, tiles_y_ = 0;
};

}  // namespace pac::raster
