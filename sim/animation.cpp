#include "sim/animation.h"

#include <algorithm>
#include <utility>

#include "jpeg/jpeg.h"
#include "sim/animation_parts.h"

namespace pac::sim {

namespace {

Result<void> check(const AnimationOptions& options) {
  if (options.frames < 1) return Failure{Error::bad_argument, 0, "a sequence has at least one frame"};
  if (!(options.quality > 0 && options.quality <= 100))
    return Failure{Error::bad_argument, 0, "quality must be in (0, 100]"};
  if (options.frames_per_second < 1 || options.frames_per_second > 60)
    return Failure{Error::bad_argument, 0, "frames a second must be 1..60"};
  if (options.codec == VideoCodec::mpeg1 && options.render.transmit_model)
    return Failure{Error::bad_argument, 0, "MPEG-1 video is coded against a model that is resident"};
  if (options.codec == VideoCodec::mjpeg && options.still_prediction != Prediction::none) {
    if (options.still_prediction == Prediction::block)
      return Failure{Error::bad_argument, 0, "stills are predicted by the model or from nothing"};
    if (options.render.transmit_model)
      return Failure{Error::bad_argument, 0, "stills are predicted by a model that is resident"};
  }
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
Result<void> run_mjpeg(SceneSet scene, const CameraPath& path, const AnimationOptions& options,
                       const AnimationSink& sink, Animation& out) {
  PAC_CHECK(pose(options, 0, scene.fine));
  ServerOptions server_options = server_options_for(options, out);
  if (options.still_prediction == Prediction::model) server_options.codec = Codec::predicted_jpeg;
  server_options.video.key_interval = options.video.key_interval;
  PAC_TRY(Server server, Server::create(std::move(scene), out.split, server_options));
  PAC_TRY(Client client, Client::create(server.session(), client_options_for(options)));
  out.resident_model_bytes = options.render.transmit_model ? 0 : server.session().size();
  if (sink.session) sink.session(server.session());
  const float aspect = static_cast<float>(out.width) / static_cast<float>(out.height);
  for (int number = 0; number < options.frames; ++number) {
    const raster::Camera camera = path(number, aspect);
    if (options.objects) PAC_CHECK(server.move_objects(options.objects(number)));
    PAC_TRY(FrameImages images, server.render(camera));
    PAC_TRY(const CodedImage coded,
            code_at_quality(images.high.view(), Content::image, options.quality, options.coding));
    PAC_TRY(const RgbImage shown, jpeg::decode(coded.bytes, {}, options.coding.isa));
    PAC_TRY(const Bytes packet,
            server.send(static_cast<uint32_t>(number), camera, std::move(images), coded.bytes.size()));
    PAC_CHECK(show_frame(number, options, sink, {coded.bytes, coded.quality, shown}, server, client, packet, out));
  }
  return {};
}

}  // namespace

Result<void> pose(const AnimationOptions& options, int number, raster::Scene& fine) {
  return options.objects ? move_objects(options.objects(number), fine) : Result<void>{};
}

ServerOptions server_options_for(const AnimationOptions& options, const Animation& out) {
  ServerOptions server;
  server.width = out.width;
  server.height = out.height;
  server.transmit_model = options.render.transmit_model;
  server.coding = options.coding;
  server.threads = options.render.threads;
  server.isa = options.render.isa;
  return server;
}

ClientOptions client_options_for(const AnimationOptions& options) {
  ClientOptions client;
  client.threads = options.render.threads;
  client.isa = options.render.isa;
  return client;
}

Result<void> show_frame(int number, const AnimationOptions& options, const AnimationSink& sink,
                        const ImageArmFrame& image, const Server& server, Client& client, const Bytes& packet,
                        Animation& out) {
  PAC_TRY(const RgbImage composite, client.receive(packet));
  const ServerFrame& sent = server.last_frame();
  if (!same_picture(composite, sent.composite))
    return Failure{Error::corrupt, static_cast<uint64_t>(number), "the client shows another picture"};
  const ScoredPair pairs[] = {{sent.high.view(), image.shown.view()}, {sent.high.view(), composite.view()}};
  const std::vector<FrameScores> scores = score_frames(pairs, options.render.threads);
  add_frame(out.image_based, image.code.size(), image.quality, scores[0]);
  const bool is_video = options.codec == VideoCodec::mpeg1;
  const uint64_t charged = is_video ? packet.size() : sent.difference_bytes + sent.model_bytes + sent.object_bytes;
  add_frame(out.polygon_assisted, charged, sent.quality, scores[1]);
  out.packet_bytes += packet.size();
  if (!sink.frame) return {};
  sink.frame({number, sent.high, image.shown, composite, image.code, sent.code, packet});
  return {};
}

Result<Animation> run_animation(SceneSet scene, const CameraPath& path, const AnimationOptions& options,
                                const AnimationSink& sink) {
  PAC_CHECK(check(options));
  const RenderOptions& render = options.render;
  Animation out;
  out.width = render.width > 0 ? render.width : scene.width;
  out.height = render.height > 0 ? render.height : scene.height;
  PAC_TRY(out.split, make_split(render.split.empty() ? scene.default_split : std::string_view(render.split), scene,
                                {render.samples, options.codec == VideoCodec::mpeg1}));
  if (options.codec == VideoCodec::mpeg1) {
    PAC_CHECK(run_mpeg1(std::move(scene), path, options, sink, out));
  } else {
    PAC_CHECK(run_mjpeg(std::move(scene), path, options, sink, out));
  }
  return out;
}

}  // namespace pac::sim
