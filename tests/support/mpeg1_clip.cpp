#include "tests/support/mpeg1_clip.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/metrics.h"
#include "base/y4m.h"

namespace pac::test {
namespace {

// Smooth noise with detail of several sizes, 0..255.
int texture(int x, int y, int seed) {
  const auto hash = [&](int i, int j, int octave) {
    uint32_t h = static_cast<uint32_t>(i) * 0x9E3779B1u ^ static_cast<uint32_t>(j) * 0x85EBCA77u ^
                 static_cast<uint32_t>(seed + octave * 131) * 0xC2B2AE3Du;
    h ^= h >> 15;
    h *= 0x2C1B3C6Du;
    return static_cast<int>(h >> 24);
  };
  int sum = 0;
  for (int octave = 0; octave < 3; ++octave) {
    const int cell = 16 >> octave, i = (x + 4096) / cell, j = (y + 4096) / cell;
    const int u = (x + 4096) % cell, v = (y + 4096) % cell;
    const int top = hash(i, j, octave) * (cell - u) + hash(i + 1, j, octave) * u;
    const int bottom = hash(i, j + 1, octave) * (cell - u) + hash(i + 1, j + 1, octave) * u;
    sum += (top * (cell - v) + bottom * v) / (cell * cell) >> octave;
  }
  return std::min(255, sum * 4 / 7);
}

bool in_disc(int x, int y, int width, int height, int time) {
  const int dx = x - (width / 5 + 3 * time), dy = y - (height / 2 + time);
  return dx * dx + dy * dy < height * height / 16;
}

bool equal_planes(const PlaneView<const uint8_t>& a, const PlaneView<const uint8_t>& b) {
  if (a.width != b.width || a.height != b.height) return false;
  for (int y = 0; y < a.height; ++y)
    if (std::memcmp(a.row(y), b.row(y), static_cast<size_t>(a.width)) != 0) return false;
  return true;
}

}  // namespace

Frame420 clip_frame(int width, int height, int time, int seed) {
  Frame420 frame(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool disc = in_disc(x, y, width, height, time);
      const int ground = texture(x + 2 * time, y + time / 2, seed);
      frame.y.row(y)[x] = static_cast<uint8_t>(disc ? 255 - texture(x - 3 * time, y - time, seed + 7) / 2 : ground);
    }
  for (int y = 0; y < frame.cb.height(); ++y)
    for (int x = 0; x < frame.cb.width(); ++x) {
      const bool disc = in_disc(2 * x, 2 * y, width, height, time);
      frame.cb.row(y)[x] = static_cast<uint8_t>(disc ? 90 : 110 + texture(x + time, y, seed + 1) / 8);
      frame.cr.row(y)[x] = static_cast<uint8_t>(disc ? 170 + time % 8 : 128);
    }
  return frame;
}

std::vector<Frame420> clip(int width, int height, int n_frames, int seed) {
  std::vector<Frame420> frames;
  for (int time = 0; time < n_frames; ++time) frames.push_back(clip_frame(width, height, time, seed));
  return frames;
}

std::vector<uint8_t> encode_clip(const std::vector<Frame420>& frames, const mpeg1::SequenceOptions& options, Isa isa) {
  auto encoder = mpeg1::Encoder::create(options, isa);
  REQUIRE(encoder.ok());
  std::vector<uint8_t> bytes;
  for (const Frame420& frame : frames) REQUIRE(encoder->add(frame, bytes).ok());
  encoder->finish(bytes);
  return bytes;
}

std::vector<const Frame420*> frames_after(const std::vector<Frame420>& frames, size_t i) {
  std::vector<const Frame420*> following;
  for (size_t k = i + 1; k < frames.size(); ++k) following.push_back(&frames[k]);
  return following;
}

std::vector<uint8_t> encode_known_clip(const std::vector<Frame420>& frames, const mpeg1::SequenceOptions& options,
                                       Isa isa) {
  auto encoder = mpeg1::Encoder::create(options, isa);
  REQUIRE(encoder.ok());
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i < frames.size(); ++i) {
    const std::vector<const Frame420*> following = frames_after(frames, i);
    mpeg1::PictureOptions picture;
    picture.following = following;
    REQUIRE(encoder->add(frames[i], bytes, picture).ok());
  }
  encoder->finish(bytes);
  return bytes;
}

std::vector<Frame420> decode_all(std::span<const uint8_t> bytes, const mpeg1::DecoderOptions& options,
                                 mpeg1::ErrorReport* report, Isa isa) {
  mpeg1::Decoder decoder(options, isa);
  decoder.feed(bytes);
  decoder.finish();
  std::vector<Frame420> frames;
  for (;;) {
    const auto picture = decoder.next();
    REQUIRE(picture.ok());
    if (*picture == nullptr) break;
    frames.push_back(mpeg1::copy_of((*picture)->view));
  }
  if (report != nullptr) *report = decoder.report();
  return frames;
}

std::vector<Frame420> read_y4m(const std::string& path) {
  const std::vector<uint8_t> bytes = read_bytes(path);
  auto reader = Y4mReader::open(bytes);
  REQUIRE(reader.ok());
  std::vector<Frame420> frames;
  for (Frame420 frame;; frame = Frame420()) {
    const auto more = reader->next(frame);
    REQUIRE(more.ok());
    if (!*more) return frames;
    frames.push_back(std::move(frame));
  }
}

std::vector<Frame420> ffmpeg_decodes(const TempDir& dir, const std::string& stream) {
  REQUIRE(run("ffmpeg -v error -xerror -y -i " + stream + " -vsync passthrough " + dir.file("theirs.y4m")) == 0);
  return read_y4m(dir.file("theirs.y4m"));
}

bool equal(const mpeg1::FrameView& a, const mpeg1::FrameView& b) {
  return equal_planes(a.y, b.y) && equal_planes(a.cb, b.cb) && equal_planes(a.cr, b.cr);
}

double psnr(const mpeg1::FrameView& a, const mpeg1::FrameView& b) {
  const auto weighted = [](const PlaneView<const uint8_t>& p, const PlaneView<const uint8_t>& q) {
    return mean_squared_error(p, q) * p.width * p.height;
  };
  const double samples = a.y.width * a.y.height + 2.0 * a.cb.width * a.cb.height;
  return psnr_from_mse((weighted(a.y, b.y) + weighted(a.cb, b.cb) + weighted(a.cr, b.cr)) / samples);
}

}  // namespace pac::test
