#include "sim/server.h"

#include <optional>
#include <utility>

#include "jpeg/jpeg.h"
#include "sim/difference.h"
#include "sim/frame_renderer.h"
#include "sim/packet.h"
#include "sim/predicted_stills.h"

namespace pac::sim {

struct Server::State {
  SceneSet scene;
  ServerOptions options;
  FrameRenderer renderer;
  Bytes session;
  ServerFrame last;
  std::optional<AssistedEncoder> video;
  std::optional<StillPredictor> stills;
  int since_key = -1;  // of stills; -1: none yet
  bool key_requested = false;
  PacketWriter packets;

  bool next_still_stands_alone() const {
    const int interval = options.video.key_interval;
    return key_requested || since_key < 0 || (interval > 0 && since_key + 1 >= interval);
  }
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
  std::optional<AssistedEncoder> video;
  std::optional<StillPredictor> stills;
  if (options.codec != Codec::jpeg) {
    if (options.transmit_model)
      return Failure{Error::bad_argument, 0, "video is coded against a model that is resident"};
    const AssistedScene seen{options.width, options.height, &renderer.low_scene(), split.low.samples,
                             split.differs_in_light()};
    if (options.codec == Codec::mpeg1) {
      PAC_TRY(video, AssistedEncoder::create(seen, options.video, options.isa));
    } else {
      stills.emplace(seen, options.isa);
    }
  }
  // A transmitted model travels where it is.
  PacketWriter packets(options.transmit_model ? Transforms{} : transforms_of(renderer.low_scene()));
  return Server(std::make_unique<State>(State{std::move(scene),
                                              options,
                                              std::move(renderer),
                                              std::move(session),
                                              {},
                                              std::move(video),
                                              std::move(stills),
                                              -1,
                                              false,
                                              std::move(packets)}));
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

const LeakyBucket* Server::bucket() const {
  return state_->options.video.rate.is_on() && state_->video ? &state_->video->bucket() : nullptr;
}

Result<void> Server::move_objects(std::span<const glm::mat4> transforms) {
  return sim::move_objects(transforms, state_->scene.fine);
}

Result<Bytes> Server::frame(uint32_t frame_number, const raster::Camera& camera) {
  PAC_TRY(FrameImages images, render(camera));
  return send(frame_number, camera, std::move(images), state_->options.target_bytes);
}

Result<FrameImages> Server::render(const raster::Camera& camera) {
  return state_->renderer.render(state_->scene, camera, state_->options.codec != Codec::jpeg);
}

void Server::request_key() {
  state_->key_requested = true;
}

namespace {

// What one codec makes of a frame.
struct CodedFrame {
  double quality = 0;
  Bytes bytes, picture;  // as sent; as a stock decoder reads them, where they differ
  RgbImage composite;
  AssistedReport video;
};

Result<CodedFrame> code_jpeg(const FrameImages& images, const ServerOptions& options, uint64_t target_bytes) {
  const ConstRgbView difference = images.difference.view(), seen = images.high.view();
  PAC_TRY(CodedImage coded,
          target_bytes > 0 ? code_at_size(difference, Content::difference, target_bytes, options.coding, seen)
                           : code_at_quality(difference, Content::difference, options.quality, options.coding, seen));
  PAC_TRY(const RgbImage decoded, jpeg::decode(coded.bytes, {}, options.isa));
  CodedFrame out;
  out.quality = coded.quality;
  out.bytes = std::move(coded.bytes);
  out.composite = RgbImage(options.width, options.height);
  composite_image(images.low.view(), decoded.view(), out.composite.view(), options.isa);
  return out;
}

// D of the frame against its prediction takes the place of images.difference.
Result<CodedFrame> code_still(FrameImages& images, const raster::Camera& camera, const ServerOptions& options,
                              StillPredictor& stills, bool key, uint64_t target_bytes) {
  const ConstRgbView predicted =
      stills.predict(key, images.low.view(), images.depth.view(), images.id.view(), camera, images.objects);
  difference_image(images.high.view(), predicted, images.difference.view(), options.isa);
  PAC_TRY(CodedFrame out, code_jpeg(images, options, target_bytes > 1 ? target_bytes - 1 : target_bytes));
  PAC_TRY(const RgbImage decoded, jpeg::decode(out.bytes, {}, options.isa));
  stills.show(decoded.view(), out.composite.view());
  out.picture = out.bytes;
  out.bytes.insert(out.bytes.begin(), key ? uint8_t{1} : uint8_t{0});
  out.video.is_key = key;
  return out;
}

Result<CodedFrame> code_video(const FrameImages& images, const raster::Camera& camera, const ServerOptions& options,
                              AssistedEncoder& video, bool key, uint64_t overhead_bytes) {
  CodedFrame out;
  const AssistedFrame frame{images.high.view(), images.low.view(), images.depth.view(), images.id.view(), camera,
                            overhead_bytes,     images.objects};
  PAC_TRY(out.video, video.encode(frame, out.bytes, key));
  out.picture.assign(video.picture().begin(), video.picture().end());
  out.quality = out.video.quantizer_scale;
  out.composite = RgbImage(options.width, options.height);
  video.composite(images.low.view(), out.composite.view());
  return out;
}

}  // namespace

Result<Bytes> Server::send(uint32_t frame_number, const raster::Camera& camera, FrameImages images,
                           uint64_t target_bytes) {
  const ServerOptions& options = state_->options;
  FramePacket packet;
  packet.frame = frame_number;
  packet.codec = options.codec;
  packet.has_model = options.transmit_model;
  packet.camera = camera;
  if (!options.transmit_model) packet.objects = images.objects;
  const bool is_key = state_->stills ? state_->next_still_stands_alone()
                                     : state_->video && state_->video->next_is_key(state_->key_requested);
  const uint64_t overhead = state_->packets.overhead_bytes(packet, is_key);
  PAC_TRY(CodedFrame coded, state_->video ? code_video(images, camera, options, *state_->video, is_key, overhead)
                            : state_->stills
                                ? code_still(images, camera, options, *state_->stills, is_key, target_bytes)
                                : code_jpeg(images, options, target_bytes));
  state_->key_requested = false;
  state_->since_key = is_key ? 0 : state_->since_key + 1;

  packet.quality = coded.quality;
  packet.low_hash = image_hash(images.low.view());
  packet.model = images.model.bytes;
  packet.difference = coded.bytes;
  Bytes bytes = state_->packets.write(packet, coded.video.is_key);

  ServerFrame& last = state_->last;
  last.composite = std::move(coded.composite);
  last.video = coded.video;
  last.high = std::move(images.high);
  last.low = std::move(images.low);
  last.difference = std::move(images.difference);
  last.quality = coded.quality;
  last.model_bytes = images.model.bytes.size();
  last.difference_bytes = coded.bytes.size();
  last.code = std::move(options.codec != Codec::jpeg ? coded.picture : coded.bytes);
  last.packet_bytes = bytes.size();
  const bool is_whole = bytes.size() >= kFramePacketOverhead + last.model_bytes + last.difference_bytes;
  last.object_bytes = is_whole ? bytes.size() - kFramePacketOverhead - last.model_bytes - last.difference_bytes : 0;
  return bytes;
}

}  // namespace pac::sim
