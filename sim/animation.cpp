#include "sim/animation.h"

#include <algorithm>
#include <string>
#include <utility>

#include "jpeg/jpeg.h"
#include "sim/client.h"
#include "sim/packet.h"
#include "sim/server.h"

namespace pac::sim {

namespace {

Result<void> check(const AnimationOptions& options) {
  if (options.frames < 1) return Failure{Error::bad_argument, 0, "a sequence has at least one frame"};
  if (!(options.quality > 0 && options.quality <= 100))
    return Failure{Error::bad_argument, 0, "quality must be in (0, 100]"};
  return {};
}

void add_frame(VideoArm& arm, uint64_t bytes, double quality, const FrameScores& scores) {
  arm.frames.push_back({bytes, quality, scores});
  arm.bytes += bytes;
}

bool same_picture(const RgbImage& a, const RgbImage& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + 3 * a.width(), b.row(y))) return false;
  return true;
}

// Motion JPEG: every frame a file of its own, D matched to the size of H's.
class JpegAnimation {
 public:
  JpegAnimation(Server server, Client client, const AnimationOptions& options, const AnimationSink& sink)
      : server_(std::move(server)), client_(std::move(client)), options_(options), sink_(sink) {}

  Result<void> frame(int number, const raster::Camera& camera, Animation& out) {
    PAC_TRY(FrameImages images, server_.render(camera));
    PAC_TRY(const CodedImage coded,
            code_at_quality(images.high.view(), Content::image, options_.quality, options_.coding));
    PAC_TRY(const RgbImage shown, jpeg::decode(coded.bytes, {}, options_.coding.isa));
    PAC_TRY(const Bytes packet,
            server_.send(static_cast<uint32_t>(number), camera, std::move(images), coded.bytes.size()));
    PAC_TRY(const RgbImage composite, client_.receive(packet));
    const ServerFrame& sent = server_.last_frame();
    if (!same_picture(composite, sent.composite))
      return Failure{Error::corrupt, static_cast<uint64_t>(number), "the client shows another picture"};

    const ScoredPair pairs[] = {{sent.high.view(), shown.view()}, {sent.high.view(), composite.view()}};
    const std::vector<FrameScores> scores = score_frames(pairs, options_.render.threads);
    add_frame(out.image_based, coded.bytes.size(), coded.quality, scores[0]);
    add_frame(out.polygon_assisted, sent.difference_bytes + sent.model_bytes, sent.quality, scores[1]);
    out.packet_bytes += packet.size();
    if (!sink_.frame) return {};
    PAC_TRY(const FramePacket fields, read_frame_packet(packet));
    sink_.frame({number, sent.high, shown, composite, coded.bytes, fields.difference, packet});
    return {};
  }

 private:
  Server server_;
  Client client_;
  const AnimationOptions& options_;
  const AnimationSink& sink_;
};

}  // namespace

Result<Animation> run_animation(SceneSet scene, const CameraPath& path, const AnimationOptions& options,
                                const AnimationSink& sink) {
  PAC_CHECK(check(options));
  const RenderOptions& render = options.render;
  Animation out;
  out.width = render.width > 0 ? render.width : scene.width;
  out.height = render.height > 0 ? render.height : scene.height;
  PAC_TRY(out.split, make_split(render.split.empty() ? scene.default_split : std::string_view(render.split), scene,
                                {render.samples}));
  ServerOptions server_options;
  server_options.width = out.width;
  server_options.height = out.height;
  server_options.transmit_model = render.transmit_model;
  server_options.coding = options.coding;
  server_options.threads = render.threads;
  server_options.isa = render.isa;
  PAC_TRY(Server server, Server::create(std::move(scene), out.split, server_options));
  ClientOptions client_options;
  client_options.threads = render.threads;
  client_options.isa = render.isa;
  PAC_TRY(Client client, Client::create(server.session(), client_options));
  out.resident_model_bytes = render.transmit_model ? 0 : server.session().size();
  if (sink.session) sink.session(server.session());

  const float aspect = static_cast<float>(out.width) / static_cast<float>(out.height);
  JpegAnimation animation(std::move(server), std::move(client), options, sink);
  for (int number = 0; number < options.frames; ++number) PAC_CHECK(animation.frame(number, path(number, aspect), out));
  return out;
}

}  // namespace pac::sim
