// MPEG-1 through both arms: the sequence drawn once, quantizers searched, then what a server sends and a client shows.
#include <algorithm>
#include <utility>

#include "sim/animation_parts.h"
#include "sim/client.h"
#include "sim/packet.h"
#include "sim/server.h"
#include "sim/video_sequence.h"

namespace pac::sim {

namespace {

class VideoAnimation {
 public:
  VideoAnimation(const AnimationOptions& options, const AssistedScene& scene)
      : options_(options), scene_(scene), video_(options.video) {
    image_.quantizer_scale = options.quantizer_scale;
    image_.picture_rate_code = video_.picture_rate_code = mpeg1::picture_rate_code(1000 * options.frames_per_second);
    image_.group_length = longest_group(video_.key_interval > 0 ? video_.key_interval : 132);
    image_.effort = video_.effort;
    image_.threads = options.render.threads;
    image_.isa = options.render.isa;
  }

  // Both arms' quantizers; then the image-based arm is there to be shown.
  Result<void> choose(const std::vector<Shot>& shots) {
    if (options_.bit_rate_bps > 0) return choose_at_rate(shots);
    PAC_TRY(shown_, code_image_video(shots, image_, true));
    const uint64_t target = total_bytes(shown_);
    PAC_TRY(video_.quantizer_scale, quantizer_for_bytes(target, 12, [&](double quantizer) -> Result<uint64_t> {
              AssistedVideoOptions pass = video_;
              pass.quantizer_scale = quantizer;
              PAC_TRY(const auto frames, code_assisted_video(shots, scene_, pass, image_.isa, false));
              return total_bytes(frames);
            }));
    return {};
  }

  const AssistedVideoOptions& video() const { return video_; }
  const VideoFrame& image_frame(size_t i) const { return shown_[i]; }

 private:
  // Players' files repeat pictures of slow sequences: they count among a group's 132 [2.4.4.2].
  int longest_group(int wanted) const {
    const int legal_milli = mpeg1::kPictureRatesMilli[image_.picture_rate_code];
    return std::clamp(132 * 1000 * options_.frames_per_second / legal_milli, 1, wanted);
  }

  // The polygon-assisted arm as it goes; the other one, with all frames known, at its bytes.
  Result<void> choose_at_rate(const std::vector<Shot>& shots) {
    video_.rate = {options_.bit_rate_bps, options_.frames_per_second, options_.buffer_seconds};
    PAC_TRY(const auto sent, code_assisted_video(shots, scene_, video_, image_.isa, false));
    PAC_TRY(image_.quantizer_scale,
            quantizer_for_bytes(total_bytes(sent), 8, [&](double quantizer) -> Result<uint64_t> {
              ImageVideoOptions pass = image_;
              pass.quantizer_scale = quantizer;
              PAC_TRY(const auto frames, code_image_video(shots, pass, false));
              return total_bytes(frames);
            }));
    PAC_TRY(shown_, code_image_video(shots, image_, true));
    return {};
  }

  const AnimationOptions& options_;
  AssistedScene scene_;
  AssistedVideoOptions video_;
  ImageVideoOptions image_;
  std::vector<VideoFrame> shown_;
};

}  // namespace

Result<void> run_mpeg1(SceneSet scene, const CameraPath& path, const AnimationOptions& options,
                       const AnimationSink& sink, Animation& out) {
  const RenderOptions& render = options.render;
  const float aspect = static_cast<float>(out.width) / static_cast<float>(out.height);
  std::vector<Shot> shots;
  PAC_TRY(FrameRenderer renderer,
          FrameRenderer::create(scene, out.split, false, out.width, out.height, render.threads, render.isa));
  for (int number = 0; number < options.frames; ++number) {
    const raster::Camera camera = path(number, aspect);
    PAC_CHECK(pose(options, number, scene.fine));
    PAC_TRY(FrameImages images, renderer.render(scene, camera, true));
    shots.push_back({camera, std::move(images)});
  }
  PAC_CHECK(pose(options, 0, scene.fine));  // as the session message will have them
  VideoAnimation both(
      options, {out.width, out.height, &renderer.low_scene(), out.split.low.samples, out.split.differs_in_light()});
  PAC_CHECK(both.choose(shots));
  ServerOptions server_options = server_options_for(options, out);
  server_options.codec = Codec::mpeg1;
  server_options.video = both.video();
  PAC_TRY(Server server, Server::create(std::move(scene), out.split, server_options));
  PAC_TRY(Client client, Client::create(server.session(), client_options_for(options)));
  out.resident_model_bytes = server.session().size();
  if (sink.session) sink.session(server.session());
  for (size_t i = 0; i < shots.size(); ++i) {
    const VideoFrame& image = both.image_frame(i);
    PAC_TRY(const Bytes packet, server.send(static_cast<uint32_t>(i), shots[i].camera, std::move(shots[i].images), 0));
    PAC_CHECK(show_frame(static_cast<int>(i), options, sink, {image.code, image.quantizer_scale, image.shown}, server,
                         client, packet, out));
  }
  if (options.bit_rate_bps > 0) {
    out.bucket_bytes = server.bucket()->capacity_bytes();
    out.fullest_bucket_bytes = server.bucket()->fullest_bytes();
  }
  return {};
}

}  // namespace pac::sim
