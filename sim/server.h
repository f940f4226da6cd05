// The rendering server [Levoy95 s.2, figure 1]: draws H and L, codes their difference, and knows what the client will
// show.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/file_io.h"
#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"
#include "raster/scene.h"
#include "sim/assisted_video.h"
#include "sim/frame_renderer.h"
#include "sim/match.h"
#include "sim/packet.h"
#include "sim/scenes.h"
#include "sim/split.h"

namespace pac::sim {

struct ServerOptions {
  int width = 512, height = 512;  // pixels, 1..65535
  double quality = 41;            // coded quality of D (the paper's notation), (0, 100]
  uint64_t target_bytes = 0;      // > 0: search the quality for this difference size instead, frame by frame
  bool transmit_model = false;    // false: the model is resident, in the session message
  CodingOptions coding;           // codec jpeg
  Codec codec = Codec::jpeg;
  // codec mpeg1 (resident models only): quality and sizes above mean nothing to it. Of predicted_jpeg (resident models
  // only, too) key_interval alone.
  AssistedVideoOptions video;
  int threads = 1;  // of the renderer; 0 = all. Results never depend on it
  Isa isa = best_isa();
};

// What the server knows of the frame it just sent; valid until the next frame() call.
struct ServerFrame {
  RgbImage high, low, difference;  // predicted_jpeg: difference is H against the prediction
  RgbImage composite;              // what a client will show, bit for bit
  double quality = 0;              // coded quality of D; codec mpeg1: quantizer_scale
  AssistedReport video;            // codec mpeg1
  Bytes code;                      // of the difference: JPEG, or MPEG-1 as it was before it was packed
  // object_bytes: of a whole packet, what it says of moved objects (of a short one they are part of the packet).
  uint64_t model_bytes = 0, difference_bytes = 0, object_bytes = 0, packet_bytes = 0;
};

// One object, one thread at a time; distinct objects are independent.
class Server {
 public:
  // Takes the scene over. Fails with bad_argument (size, quality; a transmitted model holds no texture coordinates, so
  // a split whose L is textured cannot transmit it).
  static Result<Server> create(SceneSet scene, Split split, const ServerOptions& options = {});
  ~Server();
  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;

  // The session message: sent once, before any frame. Holds the resident model, or only size and quality.
  const Bytes& session() const;

  // World from object of each object of the fine model, from the next render() on; until the first call they are where
  // the scene given to create() has them. Fails as sim::move_objects.
  Result<void> move_objects(std::span<const glm::mat4> transforms);

  // Renders, subtracts, codes: one packet. `frame_number` is free. The same as render() and send() with
  // options.target_bytes.
  Result<Bytes> frame(uint32_t frame_number, const raster::Camera& camera);

  // The two halves of frame(), for a caller who decides on the size once H is seen. target_bytes > 0: of the
  // difference.
  Result<FrameImages> render(const raster::Camera& camera);
  Result<Bytes> send(uint32_t frame_number, const raster::Camera& camera, FrameImages images, uint64_t target_bytes);

  const ServerFrame& last_frame() const;

  // The leaky bucket of options.video.rate; null without one.
  const LeakyBucket* bucket() const;

  // The next frame stands alone (codec mpeg1, predicted_jpeg): what a client asks for that has lost one.
  void request_key();

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pac::sim
