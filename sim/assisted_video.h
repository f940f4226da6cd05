// The difference of H and L as MPEG-1 video, as the server codes it and as the client decodes it. Both hold the same
// state and run the same code on it: there is no drift.
//
//   prediction none    every picture stands alone
//              block   MPEG-1's own: blocks of the picture before, moved [Levoy95 s.3]; the search for where to
//                      begins with what the model knows (sim/model_vectors.h)
//              model   the decoded difference carried by the model (sim/model_prediction.h)
//   difference halved  D = 127 + (H-L)/2 in RGB, as the paper; a stock decoder shows it as a picture
//              full    P pictures that predict H itself from L (+ carried difference): nothing is divided by two, and
//                      what the model predicts well is a skipped macroblock
// block codes halved differences; none and model either. The macroblock syntax is MPEG-1's throughout: only the
// reference picture is replaced. Where it is, no stock decoder shows the stream anyway: its pictures are packed
// (sim/picture_packing.h), and unpacked they are MPEG-1's to the bit.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/file_io.h"
#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"
#include "mpeg1/mpeg1.h"
#include "raster/renderer.h"
#include "raster/scene.h"
#include "sim/bit_rate.h"
#include "sim/quantizer_adaptation.h"

namespace pac::sim {

enum class Prediction : uint8_t { none, block, model };
enum class Difference : uint8_t { halved, full };
// Of full differences: of samples, or of their logarithms (sim/log_domain.h), where what light does to a texture is the
// same difference whatever the texel. by_scene: ratio where H and L differ in light alone.
enum class Residual : uint8_t { by_scene, additive, ratio };

struct AssistedVideoOptions {
  Prediction prediction = Prediction::model;
  Difference difference = Difference::full;
  Residual residual = Residual::by_scene;  // of halved differences: additive
  double quantizer_scale = 16;             // 1..31, real-valued, of P pictures
  double key_quantizer_scale = 0;          // of pictures that stand alone; 0: key_quantizer_for(options)
  int key_interval = 132;                  // 1..132: pictures from one that stands alone to the next; 0: the first only
  int picture_rate_code = 3;               // for the headers only
  mpeg1::Effort effort = mpeg1::Effort::normal;
  bool is_packed = true;  // where the reference picture is replaced
  bool is_priced = true;  // packed pictures above Effort::fast are coded again at what their bits cost packed
  // Pictures that stand alone: finer where H is smooth, coarser where its texture hides errors.
  bool adapts_to_texture = false;
  Foreground foreground;  // what is quantized finer than the quantizers above say, or coarser
  BitRate rate;  // on: every picture's quantizer is chosen for it, and the quantizers above are where the search begins
};

// Where model prediction carries on what a key picture holds, a finer key picture pays for itself many times:
// quantizer_scale / kKeyRatio; else quantizer_scale.
constexpr double kKeyRatio = 2.5;  // measured: docs/video.md
double key_quantizer_for(const AssistedVideoOptions& options);

// One frame as the server has it. All of one size; depth and ids are L's.
struct AssistedFrame {
  ConstRgbView high, low;
  PlaneView<const float> depth;
  PlaneView<const uint32_t> id;
  const raster::Camera& camera;
  uint64_t overhead_bytes = 0;              // of its packet beside the code: the bit rate pays for it
  std::span<const glm::mat4> objects = {};  // world from object of each object of L; empty: nothing moves
};

// What both sides know of the pictures before the first one.
struct AssistedScene {
  int width = 0, height = 0;           // 1..mpeg1::kMaxWidth, kMaxHeight
  const raster::Scene* low = nullptr;  // what L draws, read in create() only
  int samples = 1;                     // of L, a pixel
  bool differs_in_light = false;       // Split::differs_in_light(); means nothing to a decoder
};

struct AssistedReport {
  bool is_key = false;
  uint64_t bytes = 0;
  double quantizer_scale = 0;
  double carried_share = 0;  // of the luma samples that model prediction found in the frame before
  int skipped_macroblocks = 0, coded_macroblocks = 0, intra_macroblocks = 0;
};

// One object, one thread at a time.
class AssistedEncoder {
 public:
  // Fails with bad_argument: sizes, ranges, block prediction of full differences, an unknown foreground.
  static Result<AssistedEncoder> create(const AssistedScene& scene, const AssistedVideoOptions& options,
                                        Isa isa = best_isa());
  ~AssistedEncoder();
  AssistedEncoder(AssistedEncoder&&) noexcept;
  AssistedEncoder& operator=(AssistedEncoder&&) noexcept;

  // What the next encode() will make, for a caller who must know before: a picture that stands alone.
  bool next_is_key(bool force_key = false) const;

  // Codes the next frame; its bytes are appended to `out`. force_key: it stands alone. quantizer_scale > 0: instead of
  // the options'; means nothing to a bit rate.
  Result<AssistedReport> encode(const AssistedFrame& frame, Bytes& out, bool force_key = false,
                                double quantizer_scale = 0);

  // What the client shows for the last frame, bit for bit. Of the frames' size.
  void composite(ConstRgbView low, RgbView shown) const;

  // The last frame's MPEG-1 picture, as it was before it was packed.
  std::span<const uint8_t> picture() const;

  // Of a bit rate; without one it has no capacity.
  const LeakyBucket& bucket() const;

 private:
  struct State;
  explicit AssistedEncoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// One object, one thread at a time.
class AssistedDecoder {
 public:
  static Result<AssistedDecoder> create(const AssistedScene& scene, const Limits& limits = {}, Isa isa = best_isa());
  ~AssistedDecoder();
  AssistedDecoder(AssistedDecoder&&) noexcept;
  AssistedDecoder& operator=(AssistedDecoder&&) noexcept;

  // One frame's bytes and the client's own rendering of it become the picture to show. Fails with truncated or corrupt;
  // the next picture that stands alone puts everything right again. Where a frame before was lost, model prediction
  // goes on from the last one that arrived: approximate until then. objects: as AssistedFrame's.
  Result<void> decode(std::span<const uint8_t> bytes, ConstRgbView low, PlaneView<const float> depth,
                      PlaneView<const uint32_t> id, const raster::Camera& camera, RgbView shown,
                      std::span<const glm::mat4> objects = {});

  // The same by rows as they are drawn: begin(), all rows of L from the top, as
  // ModelPredictor::add_rows() has them, `low` the whole picture; then end(). `bytes` and `objects` are read until
  // then. A frame that is not ended leaves the decoder ready for the next one that stands alone.
  Result<void> begin(std::span<const uint8_t> bytes, const raster::Camera& camera,
                     std::span<const glm::mat4> objects = {});
  void add_rows(ConstRgbView low, PlaneView<const float> depth, PlaneView<const uint32_t> id, int first, int last);
  Result<void> end(ConstRgbView low, RgbView shown);

  // The last picture stood alone.
  bool last_was_key() const;

 private:
  struct State;
  explicit AssistedDecoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pac::sim
