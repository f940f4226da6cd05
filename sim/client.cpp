#include "sim/client.h"

#include <optional>
#include <utility>

#include "jpeg/jpeg.h"
#include "raster/renderer.h"
#include "sim/assisted_video.h"
#include "sim/difference.h"
#include "sim/packet.h"
#include "sim/screen_model.h"

namespace pac::sim {

struct Client::State {
  ClientOptions options;
  int width = 0, height = 0;
  raster::RenderQuality quality;
  glm::vec3 background{0};
  bool resident = false;
  raster::Scene model;
  raster::Renderer renderer;
  RgbImage low;
  uint32_t frame_number = 0;
  bool exact = true;  // no picture that this one depends on was lost
  bool started = false;
  DepthImage depth;  // of L: codec mpeg1
  IdImage id;
  std::optional<AssistedDecoder> video;
  PacketReader packets;
};

namespace {

Result<RgbImage> receive_jpeg(const FramePacket& packet, const RgbImage& low, const ClientOptions& options) {
  PAC_TRY(const RgbImage difference, jpeg::decode(packet.difference, options.limits, options.isa));
  RgbImage picture(low.width(), low.height());
  composite_image(low.view(), difference.view(), picture.view(), options.isa);
  return picture;
}

}  // namespace

Result<Client> Client::create(std::span<const uint8_t> session, const ClientOptions& options) {
  PAC_TRY(const SessionMessage message, read_session_message(session));
  const uint64_t pixels = static_cast<uint64_t>(message.width) * static_cast<uint64_t>(message.height);
  if (pixels > options.limits.max_pixels)
    return Failure{Error::limit_exceeded, 8, "picture has more pixels than the limit"};
  raster::Scene model;
  if (message.has_model) {
    PAC_TRY(model, parse_model(message.model, options.limits));
  }
  raster::RendererOptions renderer_options;
  renderer_options.threads = options.threads;
  renderer_options.isa = options.isa;
  PAC_TRY(raster::Renderer renderer, raster::Renderer::create(message.width, message.height, renderer_options));
  PacketReader packets(transforms_of(model));
  return Client(std::make_unique<State>(State{options,
                                              message.width,
                                              message.height,
                                              message.low,
                                              message.background,
                                              message.has_model,
                                              std::move(model),
                                              std::move(renderer),
                                              RgbImage(message.width, message.height),
                                              0,
                                              true,
                                              false,
                                              {},
                                              {},
                                              std::nullopt,
                                              std::move(packets)}));
}

Client::Client(std::unique_ptr<State> state) : state_(std::move(state)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

const RgbImage& Client::low() const {
  return state_->low;
}

bool Client::is_exact() const {
  return state_->exact;
}

uint32_t Client::frame_number() const {
  return state_->frame_number;
}

Result<RgbImage> Client::receive(std::span<const uint8_t> bytes) {
  State& state = *state_;
  PAC_TRY(const FramePacket packet, state.packets.read(bytes));
  if (packet.has_model == state.resident)
    return Failure{Error::corrupt, 7, "packet and session disagree about where the model is"};
  const bool is_video = packet.codec == Codec::mpeg1;
  if (is_video && packet.has_model) return Failure{Error::unsupported, 6, "video against a transmitted model"};
  if (is_video && !state.video) {
    const AssistedScene seen{state.width, state.height, &state.model, state.quality.samples};
    Limits limits = state.options.limits;
    limits.max_pixels = static_cast<uint64_t>(state.width) * static_cast<uint64_t>(state.height);
    PAC_TRY(state.video, AssistedDecoder::create(seen, limits, state.options.isa));
    state.depth = DepthImage(state.width, state.height);
    state.id = IdImage(state.width, state.height);
  }
  if (!is_video) {
    // The size first: a hostile JPEG header must not make us allocate another picture than ours.
    PAC_TRY(const jpeg::Info info, jpeg::read_info(packet.difference, state.options.limits));
    if (info.width != state.width || info.height != state.height)
      return Failure{Error::corrupt, 0, "difference image has another size than the session"};
  }

  const raster::RenderTargets targets{state.low.view(), state.depth.view(), state.id.view()};
  if (packet.has_model) {
    PAC_CHECK(draw_screen_model(state.renderer, packet.model, state.quality, state.background, state.low.view(),
                                state.options.limits));
  } else {
    PAC_CHECK(move_objects(packet.objects, state.model));
    PAC_CHECK(state.renderer.render(state.model, packet.camera, state.quality, targets));
  }
  const bool in_order = state.started && packet.frame == state.frame_number + 1;
  state.frame_number = packet.frame;
  const uint64_t hash = image_hash(state.low.view());
  if ((packet.is_short ? static_cast<uint32_t>(hash) : hash) != packet.low_hash)
    return Failure{Error::corrupt, packet.is_short ? 3u : 96u, "low-quality rendering differs from the server's"};
  if (!is_video) return receive_jpeg(packet, state.low, state.options);

  RgbImage picture(state.width, state.height);
  state.exact = state.exact && in_order;
  PAC_CHECK(state.video->decode(packet.difference, state.low.view(), state.depth.view(), state.id.view(), packet.camera,
                                picture.view(), packet.objects));
  state.exact = state.exact || state.video->last_was_key();
  state.started = true;
  return picture;
}

}  // namespace pac::sim
