// A sequence drawn once and coded many times: what the searches and sweeps work on.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/file_io.h"
#include "base/result.h"
#include "raster/scene.h"
#include "sim/assisted_video.h"
#include "sim/frame_renderer.h"

namespace pac::sim {

struct Shot {
  raster::Camera camera;
  FrameImages images;  // with depth and ids
};

// One coded frame and what a viewer sees of it.
struct VideoFrame {
  Bytes code;
  uint64_t sent_bytes = 0;  // what is charged: the code, of assisted video the whole packet with camera and checksums
  RgbImage shown;
  double quantizer_scale = 0;
};

struct ImageVideoOptions {
  double quantizer_scale = 8;  // 1..31
  int group_length = 132;      // 1..132: pictures from one that stands alone to the next
  int picture_rate_code = 3;
  mpeg1::Effort effort = mpeg1::Effort::normal;
  int threads = 1;
  Isa isa = best_isa();
};

// Plain MPEG-1 of H: I and P pictures, with all frames known to the encoder. The frames' codes one after the other are
// a stream, but for sequence_end_code. keep_shown = false leaves VideoFrame::shown empty.
Result<std::vector<VideoFrame>> code_image_video(const std::vector<Shot>& shots, const ImageVideoOptions& options,
                                                 bool keep_shown);

// The polygon-assisted arm as the server codes it, where the session message has objects as the first shot does.
Result<std::vector<VideoFrame>> code_assisted_video(const std::vector<Shot>& shots, const AssistedScene& scene,
                                                    const AssistedVideoOptions& options, Isa isa, bool keep_shown);

// Of everything sent.
uint64_t total_bytes(const std::vector<VideoFrame>& frames);

// The quantizer_scale in 1..31 whose sequence has at most `target_bytes` and at least 99 % of them, as near as ten
// passes come; 31 where even that is larger, 1 where even that is smaller. `bytes_at` codes the sequence.
Result<double> quantizer_for_bytes(uint64_t target_bytes, double first_guess,
                                   const std::function<Result<uint64_t>(double quantizer_scale)>& bytes_at);

}  // namespace pac::sim
