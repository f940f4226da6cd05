// The front end: faces -> triangles -> clip -> setup -> corner attributes -> lists of triangles by tile.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "raster/clip.h"
#include "raster/renderer.h"
#include "raster/setup.h"
#include "raster/surface.h"
#include "raster/triangulate.h"

namespace pac::raster {

// Memory for one frame in blocks that stay where they are and are kept for the next frame.
template <class T>
class Arena {
 public:
  // n <= kBlock elements, contiguous, uninitialized.
  T* allocate(size_t n) {
    if (used_ + n > kBlock || block_ == 0) {
      if (block_ == blocks_.size()) blocks_.emplace_back(new T[kBlock]);
      ++block_;
      used_ = 0;
    }
    T* const result = blocks_[block_ - 1].get() + used_;
    used_ += n;
    return result;
  }
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
  const float* previous_clip;  // four a vertex, or null where nobody asks where things were
};

// The triangles of a frame in scene order, by tile. Rebuilt each frame; keeps its memory.
class DrawList {
 public:
  // Fails with corrupt where a face, index or material is out of range.
  Result<RenderStats> build(const FrameInput& input, ThreadPool& pool);

  int tiles_x() const { return tiles_x_; }
  int tiles_y() const { return tiles_y_; }
  // Replaces `out` by the triangles that may touch the tile, in scene order.
  void triangles_of(int tile, std::vector<const RasterTriangle*>& out) const;

 private:
  struct TilePair {
    uint32_t tile;
    const RasterTriangle* triangle;
  };
  // A contiguous part of the faces, worked on by one thread.
  struct Chunk {
    Arena<RasterTriangle> triangles;
    Arena<float> attributes;
    std::vector<const RasterTriangle*> list;  // all of the chunk, in order
    std::vector<TilePair> pairs;              // in order
    std::vector<uint32_t> bin_start;          // per tile, and one past the end: where its part of `bins` starts
    std::vector<const RasterTriangle*> bins;  // by tile, in order
    PolygonCutter cutter;
    RenderStats stats;
    Result<void> result;
  };
  void transform(const FrameInput& input, ThreadPool& pool);
  void process(const FrameInput& input, size_t first_face, size_t last_face, Chunk& chunk);
  void process_face(const FrameInput& input, uint32_t face_number, Chunk& chunk);
  void process_triangle(const FrameInput& input, uint32_t face_number, const uint32_t vertices[3], Chunk& chunk);
  void fill_bins(Chunk& chunk) const;

  std::vector<TransformedVertex> vertices_;
  std::vector<Chunk> chunks_;
  size_t n_chunks_ = 0;
  int tiles_x_ = 0, tiles_y_ = 0;
};

}  // namespace pac::raster
