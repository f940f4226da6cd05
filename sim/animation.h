// A sequence through both arms [Levoy95 s.3, last paragraph]: video of H against polygon-assisted video at matched
// bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/file_io.h"
#include "base/result.h"
#include "sim/assisted_video.h"
#include "sim/experiment.h"
#include "sim/match.h"
#include "sim/object_motion.h"
#include "sim/scenes.h"
#include "sim/video_scores.h"

namespace pac::sim {

enum class VideoCodec : uint8_t { mjpeg, mpeg1 };

// Frame number (from 0) and aspect (width / height) to camera.
using CameraPath = std::function<raster::Camera(int frame, float aspect)>;

// Frame number (from 0) to where the objects of SceneSet::fine are, in their order; as many as it has. Empty: they stay
// where they are.
using ObjectPath = std::function<Transforms(int frame)>;

struct AnimationOptions {
  RenderOptions render;  // split, size, samples, threads, isa; transmit_model as for stills
  CodingOptions coding;
  int frames = 48;  // >= 1
  VideoCodec codec = VideoCodec::mjpeg;
  double quality = 15;  // mjpeg: of each image-based frame, (0, 100]; D is matched to that frame's bytes
  // mjpeg: none, or model: D is H against what the frame before predicts (sim/predicted_stills.h); stills that stand
  // alone: video.key_interval.
  Prediction still_prediction = Prediction::none;

  // mpeg1. The whole sequence is held in memory, some 14 bytes a pixel: its sizes are matched by a search over the
  // quantizer of D, to 1 % and never above the image-based arm's.
  double quantizer_scale = 8;  // of the image-based arm, 1..31
  // > 0: the polygon-assisted arm is coded at this bit rate, picture by picture, through a leaky bucket
  // (sim/bit_rate.h, model prediction only); then the image-based arm's quantizer is searched for the same bytes.
  uint64_t bit_rate_bps = 0;
  double buffer_seconds = 1;   // of the bucket
  int frames_per_second = 20;  // 1..60: the next legal picture_rate that is not slower goes into the headers
  AssistedVideoOptions video;  // of the polygon-assisted arm; quantizer_scale, rate, picture_rate_code: set by the run
  ObjectPath objects;          // frame 0 is where the session message has them
};

// One arm's frame.
struct ArmFrame {
  // JPEG file, and what is transmitted of model and moved objects; MPEG picture; of assisted video the whole packet.
  uint64_t bytes = 0;
  double quality = 0;  // coded quality; mpeg1: quantizer_scale
  FrameScores scores{};
};

struct VideoArm {
  std::vector<ArmFrame> frames;
  uint64_t bytes = 0;  // of all frames
};

struct Animation {
  Split split;
  int width = 0, height = 0;
  VideoArm image_based, polygon_assisted;
  uint64_t resident_model_bytes = 0;                  // the session message, once
  uint64_t packet_bytes = 0;                          // of all frame packets: code, camera, hash, CRC
  double fullest_bucket_bytes = 0, bucket_bytes = 0;  // with a bit rate: what was in it at most, what goes in
};

// One frame as it passes by; everything is valid during the call only.
struct AnimationFrame {
  int number = 0;
  const RgbImage& high;
  const RgbImage& image_based;  // as shown
  const RgbImage& composite;    // as the client shows it
  std::span<const uint8_t> image_code;
  std::span<const uint8_t> difference_code;
  std::span<const uint8_t> packet;
};

struct AnimationSink {
  std::function<void(std::span<const uint8_t> session)> session;  // once, before the first frame; may be empty
  std::function<void(const AnimationFrame& frame)> frame;         // may be empty
};

// Renders, codes both arms, sends the packets to a client, scores what both show. The client sees nothing but bytes;
// corrupt where its picture is not the one that the server predicts. Fails as Server::create, Server::move_objects and
// Client::receive, and with bad_argument.
Result<Animation> run_animation(SceneSet scene, const CameraPath& path, const AnimationOptions& options,
                                const AnimationSink& sink = {});

}  // namespace pac::sim
