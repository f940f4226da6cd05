#include "bench/peers/experiment_codecs.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "jpeg/jpeg.h"
#include "mpeg1/mpeg1.h"
#include "sim/assisted_video.h"
#include "sim/difference.h"
#include "sim/frame420.h"
#include "sim/match.h"

namespace pac::bench {

namespace {

constexpr int kFramesPerSecond = 20;

std::vector<uint8_t> pixels_of(const RgbImage& image) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < image.height(); ++y)
    pixels.insert(pixels.end(), image.pixel(0, y), image.pixel(0, y) + 3 * image.width());
  return pixels;
}

std::optional<PeerCode> video_peer(const std::string& key, PeerRunner& runner, double setting) {
  for (const VideoPeer& peer : video_peers())
    if (key == peer.key) return runner.video(peer, static_cast<int>(setting));
  return std::nullopt;
}
std::optional<PeerCode> still_peer(const std::string& key, PeerRunner& runner, double setting) {
  for (const StillPeer& peer : still_peers())
    if (key == peer.key) return runner.still(peer, setting);
  return std::nullopt;
}

}  // namespace

std::optional<PeerCode> ExperimentCodecs::code(const ExperimentArm& arm, double setting) {
  const std::string key = arm.key;
  if (key == "jpeg" || key == "mjpeg" || key == "polygons-jpeg" || key == "polygons-mjpeg")
    return code_jpeg(arm.is_video, key.starts_with("polygons"), setting);
  if (key == "polygons-avif") return composite(still_peer("avif", differences(), setting));
  if (key == "polygons-x264") return composite(video_peer("x264-low-delay", differences(), setting));
  if (key == "mpeg1" || key.starts_with("polygons")) return code_mpeg1(arm, setting);
  return arm.is_video ? video_peer(key, pictures(), setting) : still_peer(key, pictures(), setting);
}

PeerRunner& ExperimentCodecs::runner(std::unique_ptr<PeerRunner>& runner, RgbImage sim::FrameImages::*member) const {
  if (!runner) {
    std::vector<ConstRgbView> views;
    for (const sim::Shot& shot : sequence_.shots) views.push_back((shot.images.*member).view());
    runner = std::make_unique<PeerRunner>(std::move(views), kFramesPerSecond);
  }
  return *runner;
}

// L plus twice what was shown.
std::optional<PeerCode> ExperimentCodecs::composite(std::optional<PeerCode> code) const {
  for (size_t i = 0; code && i < code->shown.size(); ++i)
    sim::composite_image(sequence_.shots[i].images.low.view(), code->shown[i].view(), code->shown[i].view());
  return code;
}

PeerCode ExperimentCodecs::code_jpeg(bool is_video, bool is_difference, double setting) const {
  sim::CodingOptions options;
  options.huffman = jpeg::Huffman::optimal;
  const sim::Content content = is_difference ? sim::Content::difference : sim::Content::image;
  PeerCode out;
  for (size_t i = 0; i < (is_video ? sequence_.shots.size() : 1); ++i) {
    const sim::FrameImages& images = sequence_.shots[i].images;
    const double begin = cpu_ms();
    const auto file = need(sim::code_at_quality((is_difference ? images.difference : images.high).view(), content,
                                                sim::coded_quality(setting, content), options),
                           "JPEG");
    const double encoded = cpu_ms();
    RgbImage shown = need(jpeg::decode(file.bytes), "JPEG");
    if (is_difference) sim::composite_image(images.low.view(), shown.view(), shown.view());
    out.encode_ms += encoded - begin;
    out.decode_ms += cpu_ms() - encoded;
    out.bytes += file.bytes.size();
    out.shown.push_back(std::move(shown));
  }
  return out;
}

PeerCode ExperimentCodecs::code_mpeg1(const ExperimentArm& arm, double setting) {
  std::vector<sim::Shot> first;  // lent: shots are not copied
  if (!arm.is_video) first.push_back(std::move(sequence_.shots[0]));
  const std::vector<sim::Shot>& shots = arm.is_video ? sequence_.shots : first;
  PeerCode out =
      std::strcmp(arm.key, "mpeg1") == 0 ? code_plain_mpeg1(shots, setting) : code_assisted(arm.key, shots, setting);
  if (!arm.is_video) sequence_.shots[0] = std::move(first[0]);
  return out;
}

PeerCode ExperimentCodecs::code_plain_mpeg1(const std::vector<sim::Shot>& shots, double setting) const {
  sim::ImageVideoOptions options;
  options.quantizer_scale = setting;
  options.effort = mpeg1::Effort::best;
  PeerCode out;
  const double begin = cpu_ms();
  const auto frames = need(sim::code_image_video(shots, options, false), "MPEG-1");
  out.encode_ms = cpu_ms() - begin;
  out.bytes = sim::total_bytes(frames);
  const double coded = cpu_ms();
  mpeg1::Decoder decoder;
  for (const sim::VideoFrame& frame : frames) decoder.feed(frame.code);
  decoder.finish();
  while (const mpeg1::DecodedPicture* picture = need(decoder.next(), "MPEG-1")) {
    RgbImage shown(sequence_.width, sequence_.height);
    sim::rgb_from_frame420(mpeg1::copy_of(picture->view), shown.view());
    out.shown.push_back(std::move(shown));
  }
  out.decode_ms = cpu_ms() - coded;
  return out;
}

// Decoded as a client does it, who has L, depth and ids; its pictures must be the server's.
PeerCode ExperimentCodecs::code_assisted(const std::string& key, const std::vector<sim::Shot>& shots,
                                         double setting) const {
  sim::AssistedVideoOptions options;
  options.prediction = key == "polygons-block"   ? sim::Prediction::block
                       : key == "polygons-model" ? sim::Prediction::model
                                                 : sim::Prediction::none;
  options.difference = key == "polygons-block" ? sim::Difference::halved : sim::Difference::full;
  options.quantizer_scale = setting;
  options.effort = mpeg1::Effort::best;
  const sim::AssistedScene scene{sequence_.width, sequence_.height, &sequence_.low, sequence_.samples,
                                 sequence_.differs_in_light};
  PeerCode out;
  const double begin = cpu_ms();
  const auto frames = need(sim::code_assisted_video(shots, scene, options, best_isa(), true), key.c_str());
  out.encode_ms = cpu_ms() - begin;
  out.bytes = sim::total_bytes(frames);
  auto decoder = need(sim::AssistedDecoder::create(scene), key.c_str());
  for (size_t i = 0; i < frames.size(); ++i) {
    const sim::FrameImages& images = shots[i].images;
    RgbImage shown(sequence_.width, sequence_.height);
    const double coded = cpu_ms();
    const auto decoded = decoder.decode(frames[i].code, images.low.view(), images.depth.view(), images.id.view(),
                                        shots[i].camera, shown.view(), images.objects);
    out.decode_ms += cpu_ms() - coded;
    if (!decoded.ok() || !std::ranges::equal(pixels_of(shown), pixels_of(frames[i].shown))) {
      std::fprintf(stderr, "%s: the client shows another picture\n", key.c_str());
      std::exit(1);
    }
    out.shown.push_back(std::move(shown));
  }
  return out;
}

}  // namespace pac::bench
