#include "sim/server.h"

#include <utility>

#include "sim/difference.h"
#include "sim/frame_renderer.h"
#include "sim/packet.h"

namespace pac::sim {

struct Server::State {
  SceneSet scene;
  ServerOptions options;
  FrameRenderer renderer;
  Bytes session;
  ServerFrame last;
};

namespace {

Bytes make_session(const raster::Scene& low, const Split& split, const ServerOptions& options) {
  SessionMessage message;
  message.width = options.width;
  message.height = options.height;
  message.low = split.low;
  message.background = low.background;
  message.has_model = !options.transmit_model;
  const Bytes model = message.has_model ? serialize_model(low, split.low.texture) : Bytes{};
  message.model = model;
  return write_session_message(message);
}

}  // namespace

Result<Server> Server::create(SceneSet scene, Split split, const ServerOptions& options) {
  if (!(options.quality > 0 && options.quality <= 100))
    return Failure{Error::bad_argument, 0, "quality must be in (0, 100]"};
  PAC_TRY(FrameRenderer renderer, FrameRenderer::create(scene, split, options.transmit_model, options.width,
                                                        options.height, options.threads, options.isa));
  Bytes session = make_session(renderer.low_scene(), split, options);
  return Server(std::make_unique<State>(State{std::move(scene), options, std::move(renderer), std::move(session), {}}));
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}
Server::~Server() = default;
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;

const Bytes& Server::session() const {
  return state_->session;
}

const ServerFrame& Server::last_frame() const {
  return state_->last;
}

Result<Bytes> Server::frame(uint32_t frame_number, const raster::Camera& camera) {
  PAC_TRY(FrameImages images, render(camera));
  return send(frame_number, camera, std::move(images), state_->options.target_bytes);
}

Result<FrameImages> Server::render(const raster::Camera& camera) {
  return state_->renderer.render(state_->scene, camera);
}

Result<Bytes> Server::send(uint32_t frame_number, const raster::Camera& camera, FrameImages images,
                           uint64_t target_bytes) {
  const ServerOptions& options = state_->options;
  const ConstRgbView difference = images.difference.view();
  PAC_TRY(const CodedImage coded,
          target_bytes > 0 ? code_at_size(difference, Content::difference, target_bytes, options.coding)
                           : code_at_quality(difference, Content::difference, options.quality, options.coding));
  PAC_TRY(const RgbImage decoded, jpeg::decode(coded.bytes, {}, options.isa));

  FramePacket packet;
  packet.frame = frame_number;
  packet.has_model = options.transmit_model;
  packet.camera = camera;
  packet.quality = coded.quality;
  packet.low_hash = image_hash(images.low.view());
  packet.model = images.model.bytes;
  packet.difference = coded.bytes;
  Bytes bytes = write_frame_packet(packet);

  ServerFrame& last = state_->last;
  last.composite = RgbImage(options.width, options.height);
  composite_image(images.low.view(), decoded.view(), last.composite.view(), options.isa);
  last.high = std::move(images.high);
  last.low = std::move(images.low);
  last.difference = std::move(images.difference);
  last.quality = coded.quality;
  last.model_bytes = images.model.bytes.size();
  last.difference_bytes = coded.bytes.size();
  last.packet_bytes = bytes.size();
  return bytes;
}

}  // namespace pac::sim
