#include "sim/video_sequence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/exact_math.h"
#include "mpeg1/mpeg1.h"
#include "sim/frame420.h"
#include "sim/packet.h"

namespace pac::sim {

Result<std::vector<VideoFrame>> code_image_video(const std::vector<Shot>& shots, const ImageVideoOptions& options,
                                                 bool keep_shown) {
  PAC_ASSERT(!shots.empty());
  const int width = shots[0].images.high.width(), height = shots[0].images.high.height();
  mpeg1::SequenceOptions sequence;
  sequence.width = width;
  sequence.height = height;
  sequence.picture_rate_code = options.picture_rate_code;
  sequence.gop_length = options.group_length;
  sequence.quantizer_scale = options.quantizer_scale;
  sequence.effort = options.effort;
  sequence.threads = options.threads;
  PAC_TRY(mpeg1::Encoder encoder, mpeg1::Encoder::create(sequence, options.isa));
  std::vector<VideoFrame> frames;
  std::vector<Frame420> sources;
  for (const Shot& shot : shots)
    frame420_from_rgb(shot.images.high.view(), sources.emplace_back(width, height), options.isa);
  std::vector<const Frame420*> following;
  for (const Frame420& source : sources) following.push_back(&source);
  for (size_t i = 0; i < sources.size(); ++i) {
    VideoFrame coded;
    mpeg1::PictureOptions picture;
    picture.following = std::span(following).subspan(i + 1);
    PAC_TRY(const mpeg1::PictureReport report, encoder.add(sources[i], coded.code, picture));
    coded.quantizer_scale = report.quantizer_scale;
    coded.sent_bytes = coded.code.size();
    if (keep_shown) {
      coded.shown = RgbImage(width, height);
      rgb_from_frame420(mpeg1::copy_of(encoder.reconstruction()), coded.shown.view(), options.isa);
    }
    frames.push_back(std::move(coded));
  }
  return frames;
}

Result<std::vector<VideoFrame>> code_assisted_video(const std::vector<Shot>& shots, const AssistedScene& scene,
                                                    const AssistedVideoOptions& options, Isa isa, bool keep_shown) {
  PAC_TRY(AssistedEncoder encoder, AssistedEncoder::create(scene, options, isa));
  std::vector<VideoFrame> frames;
  PAC_ASSERT(!shots.empty());
  PacketWriter packets(shots[0].images.objects);
  for (const Shot& shot : shots) {
    const FrameImages& images = shot.images;
    VideoFrame coded;
    FramePacket packet;
    packet.frame = static_cast<uint32_t>(frames.size());
    packet.codec = Codec::mpeg1;
    packet.camera = shot.camera;
    packet.objects = images.objects;
    const uint64_t overhead = packets.overhead_bytes(packet, encoder.next_is_key());
    PAC_TRY(const AssistedReport report, encoder.encode({images.high.view(), images.low.view(), images.depth.view(),
                                                         images.id.view(), shot.camera, overhead, images.objects},
                                                        coded.code));
    coded.quantizer_scale = report.quantizer_scale;
    packet.difference = coded.code;
    coded.sent_bytes = packets.write(packet, report.is_key).size();
    if (keep_shown) {
      coded.shown = RgbImage(images.low.width(), images.low.height());
      encoder.composite(images.low.view(), coded.shown.view());
    }
    frames.push_back(std::move(coded));
  }
  return frames;
}

uint64_t total_bytes(const std::vector<VideoFrame>& frames) {
  uint64_t bytes = 0;
  for (const VideoFrame& frame : frames) bytes += frame.sent_bytes;
  return bytes;
}

Result<double> quantizer_for_bytes(uint64_t target_bytes, double first_guess,
                                   const std::function<Result<uint64_t>(double quantizer_scale)>& bytes_at) {
  constexpr int kPasses = 10;
  constexpr double kStep = 0.01;  // of the bytes, that is no progress
  const auto target = static_cast<double>(target_bytes);
  // Bytes fall with the quantizer, nearly as a power of it: interpolate in logarithms between the nearest too large and
  // the nearest small enough.
  double low = 1, high = 31, low_bytes = 0, high_bytes = 0;  // 0: not coded
  double guess = std::clamp(first_guess, low, high);
  for (int pass = 0; pass < kPasses; ++pass) {
    PAC_TRY(const uint64_t coded, bytes_at(guess));
    const auto bytes = static_cast<double>(coded);
    const double end = bytes <= target ? high_bytes : low_bytes;
    const bool creeps = std::abs(bytes - end) < kStep * end;
    if (bytes <= target) {
      high = guess;
      high_bytes = bytes;
      if (bytes >= 0.99 * target || guess <= 1) return guess;
    } else {
      low = guess;
      low_bytes = bytes;
      if (guess >= 31) return guess;
    }
    const double power =
        low_bytes > 0 && high_bytes > 0 && high > low ? exact_log(low_bytes / high_bytes) / exact_log(high / low) : 1.0;
    double next = power > 0.1 ? guess * exact_exp(exact_log(bytes / (0.995 * target)) / power) : 0.5 * (low + high);
    // Where bytes fall in steps, interpolation creeps along a step: then the bracket is halved.
    if (creeps && low_bytes > 0 && high_bytes > 0) next = 0.5 * (low + high);
    // Towards an end that was not coded yet the way is free; else stay inside the bracket.
    const double floor = low_bytes > 0 ? low + 0.02 * (high - low) : 1.0;
    const double ceiling = high_bytes > 0 ? high - 0.02 * (high - low) : 31.0;
    next = std::clamp(next, std::min(floor, ceiling), std::max(floor, ceiling));
    if (next == guess) break;
    guess = next;
  }
  return high_bytes > 0 ? high : 31.0;
}

}  // namespace pac::sim
