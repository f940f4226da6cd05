// Model prediction: the difference that was decoded for the frame before, carried to where the model says that its
// surfaces are now. Server and client run the same code on the same numbers.
//
//   depth, cameras, objects -> flow -> visibility (object and depth) -> filter -> carried difference -> + base ->
//   reference; carried difference + coded picture - reference -> difference, kept for the next frame
// The base is the client's own rendering L (so that the reference predicts H itself), or gray (the paper's D form). All
// in 4:2:0; chroma is carried at its own resolution. Differences have five bits below the point, so that what nothing
// is coded for is not rounded again and again: kept = carried + (coded picture - reference). Where the frame before
// does not show the surface, the carried difference is 0: the reference is the base.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/isa.h"
#include "raster/scene.h"
#include "sim/bordered_plane.h"
#include "sim/deblocking.h"
#include "sim/model_flow.h"
#include "sim/row_carrier.h"
#include "sim/surface_map.h"

namespace pac::sim {

// Faces to surfaces: one number a material and object, for what learns how surfaces are coded. Index = id of the
// rasterizer (face + 1); [0] is the background.
std::vector<uint32_t> surfaces_of(const raster::Scene& low);

struct PredictionStats {
  double carried_share = 0;  // of the luma samples: found in the frame before
};

// One object, one thread at a time.
class ModelPredictor {
 public:
  // `surfaces`: surfaces_of() the scene that L draws; sample_x, sample_y: where in a pixel the rasterizer takes depth
  // and id, 0..1; `movers`: movers_of() that scene, empty where nothing moves.
  ModelPredictor(int width, int height, std::vector<uint32_t> surfaces, double sample_x, double sample_y,
                 Isa isa = best_isa(), std::vector<uint32_t> movers = {});

  // The reference picture for a frame with that base, depth and ids of L, camera and transforms of its objects (as many
  // each time, or none). After the first call and after forget() it is the base itself. Valid until the next call.
  const Frame420& reference(const Frame420& base, PlaneView<const float> depth, PlaneView<const uint32_t> id,
                            const raster::Camera& camera, std::span<const glm::mat4> objects = {});

  // The same by rows, for who has them as they are drawn: begin(), then rows from the top, first..last - 1 at a time
  // and an even number but for the last ones, of a base whose rows these are, and depth and ids whose row 0 is `first`;
  // then end(). `objects` are read until then. A frame that is not ended was not asked for.
  void begin(const raster::Camera& camera, std::span<const glm::mat4> objects = {});
  void add_rows(const Frame420& base, PlaneView<const float> depth, PlaneView<const uint32_t> id, int first, int last);
  const Frame420& end();

  // What the codec made of the frame whose reference was asked for last: kept as the difference to its base.
  // `macroblocks`: which of them, row by row, are mpeg1::kCopiedMacroblock, the reference itself; empty: any may
  // differ.
  void keep(PlaneView<const uint8_t> y, PlaneView<const uint8_t> cb, PlaneView<const uint8_t> cr,
            std::span<const uint8_t> macroblocks = {});

  // What was kept changes by the difference of two pictures of the same frame: more was decoded of it.
  void add(const Frame420& before, const Frame420& after);

  // The surface that L shows in the frame whose reference was asked for last, in the middle of blocks (columns and rows
  // 8 k + 4) and of macroblocks (16 k + 8), or where that is beyond it in the last column and row: at a quarter of such
  // a column and row. Until keep().
  PlaneView<const uint32_t> surface() const { return surface_.view(); }

  // The kept difference: luma and chroma, in 1/32.
  const BorderedPlane& difference(int component) const { return kept_[component]; }

  // From the next begin() or reference() on: what of luma is to be shown is filtered at the borders of coded blocks.
  void deblock(bool on);
  // The kept difference as it is to be shown; its border is not filled.
  const BorderedPlane& shown(int component) const {
    return deblocks_ && component == 0 ? deblocked_ : kept_[component];
  }

  // The next reference is the base: after a loss, or for a frame that must stand alone.
  void forget() { has_kept_ = false; }

  const PredictionStats& stats() const { return stats_; }

 private:
  void find_row(int y, const float* depth, const uint32_t* ids, RowCarrier& luma);
  void end_row(int y, const uint32_t* ids);
  void set_surfaces(int y, const uint32_t* ids, int step);
  void carry_row(int y, RowCarrier& luma, RowCarrier& chroma);
  void add_row(int component, int y, const Frame420& base);
  void keep_part(int component, PlaneView<const uint8_t> coded, int x, int y, int width, int height);

  int width_, height_;
  std::vector<uint32_t> surfaces_, keys_;  // by id; keys_: empty where nothing moves
  Isa isa_;
  bool has_kept_ = false;
  ModelFlow flow_;                 // to the frame whose reference was asked for last
  SurfaceMap now_[2], before_[2];  // luma, chroma
  IdImage surface_;
  BorderedPlane kept_[3];
  BorderedPlane carried_[3];  // to the frame whose reference was asked for last
  Frame420 reference_;
  PredictionStats stats_;

  // Of the frame that was begun.
  struct Begun {
    raster::Camera camera;
    std::span<const glm::mat4> objects;
    RowCarrier luma, chroma;
    uint64_t found = 0;
  };
  std::optional<Begun> begun_;

  bool deblocks_ = false;
  Deblocker deblocker_;
  BorderedPlane deblocked_;
};

}  // namespace pac::sim
