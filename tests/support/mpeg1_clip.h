// Small moving pictures for the video tests: a textured ground that pans, a disc that crosses it, a light that changes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "mpeg1/mpeg1.h"
#include "tests/support/peer.h"

namespace pac::test {

// Frame `time` of a clip of that size; `seed` gives another one.
Frame420 clip_frame(int width, int height, int time, int seed = 0);
std::vector<Frame420> clip(int width, int height, int n_frames, int seed = 0);

// All frames through an encoder, sequence end included.
std::vector<uint8_t> encode_clip(const std::vector<Frame420>& frames, const mpeg1::SequenceOptions& options,
                                 Isa isa = best_isa());
// The same where the encoder knows all frames that follow.
std::vector<uint8_t> encode_known_clip(const std::vector<Frame420>& frames, const mpeg1::SequenceOptions& options,
                                       Isa isa = best_isa());
// Those after frames[i].
std::vector<const Frame420*> frames_after(const std::vector<Frame420>& frames, size_t i);

// Every picture of a stream, in display order; `report` may be null. Fails the test where decoding fails.
std::vector<Frame420> decode_all(std::span<const uint8_t> bytes, const mpeg1::DecoderOptions& options = {},
                                 mpeg1::ErrorReport* report = nullptr, Isa isa = best_isa());

// Every frame of a Y4M file. Fails the test where it is none.
std::vector<Frame420> read_y4m(const std::string& path);
// Every picture of the stream at that path as ffmpeg decodes it; the frames go by a file in `dir`.
std::vector<Frame420> ffmpeg_decodes(const TempDir& dir, const std::string& stream);

bool equal(const mpeg1::FrameView& a, const mpeg1::FrameView& b);
// Over all samples of the three planes.
double psnr(const mpeg1::FrameView& a, const mpeg1::FrameView& b);

}  // namespace pac::test
