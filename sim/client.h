// The client [Levoy95 s.2, figure 1]: draws L, decodes D, adds, shows. Sees nothing but bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"

namespace pac::sim {

struct ClientOptions {
  int threads = 1;  // of the renderer; 0 = all. Results never depend on it
  Isa isa = best_isa();
  Limits limits;
};

// One object, one thread at a time; distinct objects are independent.
class Client {
 public:
  // Reads the session message. Fails as read_session_message and parse_model. Keeps no pointer to `session`.
  static Result<Client> create(std::span<const uint8_t> session, const ClientOptions& options = {});
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  // One frame packet becomes the picture to show. A packet that fails leaves the client ready for the next one:
  // as read_frame_packet; corrupt where the model or JPEG inside is, where the difference has another size, or where
  // this client's L is not the one that the server subtracted ("low-quality rendering differs from the server's").
  Result<RgbImage> receive(std::span<const uint8_t> packet);
  // The same into a picture that is used again: it gets the session's size where it has another. What it shows where
  // the packet fails is not specified.
  Result<void> receive(std::span<const uint8_t> packet, RgbImage& picture);

  // The low-quality rendering of the last frame that got so far, and its frame number.
  const RgbImage& low() const;
  uint32_t frame_number() const;

  // The last picture is the one that the server predicts. False after a lost frame, for video whose pictures depend on
  // others, until the next one that stands alone.
  bool is_exact() const;

 private:
  struct State;
  explicit Client(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pac::sim
