#include "sim/client.h"

#include <optional>
#include <utility>

#include "jpeg/jpeg.h"
#include "raster/renderer.h"
#include "sim/assisted_video.h"
#include "sim/difference.h"
#include "sim/packet.h"
#include "sim/predicted_stills.h"
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
  DepthImage depth;  // of L: where pictures are predicted; of video a band at a time
  IdImage id;
  std::optional<AssistedDecoder> video;
  std::optional<StillPredictor> stills;
  PacketReader packets;

  Result<void> prepare(const FramePacket& packet);
  Result<uint64_t> draw_low(const FramePacket& packet);
  Result<bool> show_still(const FramePacket& packet, RgbView picture);
};

namespace {

Result<void> receive_jpeg(const FramePacket& packet, const RgbImage& low, const ClientOptions& options,
                          RgbView picture) {
  PAC_TRY(const RgbImage difference, jpeg::decode(packet.difference, options.limits, options.isa));
  composite_image(low.view(), difference.view(), picture, options.isa);
  return {};
}

}  // namespace

// What the packet's codec needs before L is drawn, and what its JPEG says of itself.
Result<void> Client::State::prepare(const FramePacket& packet) {
  if (packet.codec != Codec::jpeg) {
    if (packet.has_model) return Failure{Error::unsupported, 6, "video against a transmitted model"};
    const AssistedScene seen{width, height, &model, quality.samples};
    if (packet.codec == Codec::mpeg1 && !video) {
      Limits limits = options.limits;
      limits.max_pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
      PAC_TRY(video, AssistedDecoder::create(seen, limits, options.isa));
    }
    if (packet.codec == Codec::predicted_jpeg && !stills) stills.emplace(seen, options.isa);
    const int rows = packet.codec == Codec::mpeg1 ? raster::kBandRows : height;
    if (depth.height() != rows) depth = DepthImage(width, rows), id = IdImage(width, rows);
  }
  if (packet.codec == Codec::mpeg1) return {};
  PacketStill still{false, packet.difference};
  if (packet.codec == Codec::predicted_jpeg) {
    PAC_TRY(still, read_packet_still(packet.difference));
  }
  // The size first: a hostile JPEG header must not make us allocate another picture than ours.
  PAC_TRY(const jpeg::Info info, jpeg::read_info(still.jpeg, options.limits));
  if (info.width != width || info.height != height)
    return Failure{Error::corrupt, 0, "difference image has another size than the session"};
  return {};
}

// L and its hash. Video is predicted from its rows as they come.
Result<uint64_t> Client::State::draw_low(const FramePacket& packet) {
  if (packet.has_model) {
    PAC_CHECK(draw_screen_model(renderer, packet.model, quality, background, low.view(), options.limits));
    return image_hash(low.view());
  }
  PAC_CHECK(move_objects(packet.objects, model));
  const raster::RenderTargets targets{low.view(), depth.view(), id.view()};
  if (packet.codec != Codec::mpeg1) {
    PAC_CHECK(renderer.render(model, packet.camera, quality, targets));
    return image_hash(low.view());
  }
  PAC_CHECK(video->begin(packet.difference, packet.camera, packet.objects));
  ImageHash hash(width, height);
  PAC_CHECK(renderer.render_bands(model, packet.camera, quality, targets, [&](int first, int last) {
    for (int y = first; y < last; ++y) hash.add_row(low.row(y));
    video->add_rows(low.view(), depth.view(), id.view(), first, last);
  }));
  return hash.finish();
}

// Whether the picture stood alone. One that is damaged changes nothing.
Result<bool> Client::State::show_still(const FramePacket& packet, RgbView picture) {
  PAC_TRY(const PacketStill still, read_packet_still(packet.difference));
  PAC_TRY(const RgbImage difference, jpeg::decode(still.jpeg, options.limits, options.isa));
  stills->predict(still.stands_alone, low.view(), depth.view(), id.view(), packet.camera, packet.objects);
  stills->show(difference.view(), picture);
  return still.stands_alone;
}

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
  RgbImage picture;
  PAC_CHECK(receive(bytes, picture));
  return picture;
}

Result<void> Client::receive(std::span<const uint8_t> bytes, RgbImage& picture) {
  State& state = *state_;
  PAC_TRY(const FramePacket packet, state.packets.read(bytes));
  if (packet.has_model == state.resident)
    return Failure{Error::corrupt, 7, "packet and session disagree about where the model is"};
  PAC_CHECK(state.prepare(packet));

  const bool was_exact = state.exact && state.started && packet.frame == state.frame_number + 1;
  if (packet.codec != Codec::jpeg) state.exact = false;  // where this picture fails, the next one depends on a lost one
  PAC_TRY(const uint64_t hash, state.draw_low(packet));
  state.frame_number = packet.frame;
  if ((packet.is_short ? static_cast<uint32_t>(hash) : hash) != packet.low_hash)
    return Failure{Error::corrupt, packet.is_short ? 3u : 96u, "low-quality rendering differs from the server's"};
  if (picture.width() != state.width || picture.height() != state.height) picture = RgbImage(state.width, state.height);
  if (packet.codec == Codec::jpeg) return receive_jpeg(packet, state.low, state.options, picture.view());

  if (packet.codec == Codec::mpeg1) {
    PAC_CHECK(state.video->end(state.low.view(), picture.view()));
    state.exact = was_exact || state.video->last_was_key();
  } else {
    PAC_TRY(const bool stands_alone, state.show_still(packet, picture.view()));
    state.exact = was_exact || stands_alone;
  }
  state.started = true;
  return {};
}

}  // namespace pac::sim
