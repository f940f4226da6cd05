// The encoder that is told which frames follow.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "base/kernels/kernels.h"
#include "tests/support/mpeg1_clip.h"

namespace pac::test {
namespace {

using mpeg1::Effort;
using mpeg1::PictureType;

mpeg1::SequenceOptions options_of(const std::vector<Frame420>& frames, double quantizer_scale) {
  mpeg1::SequenceOptions options;
  options.width = frames[0].width();
  options.height = frames[0].height();
  options.quantizer_scale = quantizer_scale;
  return options;
}

// The left half of the clip's first frame for good beside a right half in which other pictures follow one another.
std::vector<Frame420> half_still(int n_frames) {
  std::vector<Frame420> frames;
  const Frame420 still = clip_frame(192, 96, 0, 1);
  for (int i = 0; i < n_frames; ++i) {
    frames.push_back(clip_frame(192, 96, 0, 10 + i));
    const auto keep = [](const GrayImage& from, GrayImage& to) {
      for (int y = 0; y < to.height(); ++y) std::copy_n(from.row(y), to.width() / 2, to.row(y));
    };
    keep(still.y, frames.back().y);
    keep(still.cb, frames.back().cb);
    keep(still.cr, frames.back().cr);
  }
  return frames;
}

double mean_error(const std::vector<Frame420>& frames, const std::vector<Frame420>& decoded, int x0, int x1) {
  double sum = 0;
  for (size_t i = 0; i < frames.size(); ++i)
    for (int y = 0; y < frames[i].height(); ++y)
      for (int x = x0; x < x1; ++x) {
        const double difference = frames[i].y.row(y)[x] - decoded[i].y.row(y)[x];
        sum += difference * difference;
      }
  return sum / (static_cast<double>(frames.size()) * frames[0].height() * (x1 - x0));
}

TEST_CASE("what the group goes on showing has less error when the frames that follow are known") {
  const std::vector<Frame420> frames = half_still(8);
  const mpeg1::SequenceOptions options = options_of(frames, 12);
  const std::vector<Frame420> alone = decode_all(encode_clip(frames, options));
  const std::vector<Frame420> known = decode_all(encode_known_clip(frames, options));
  CHECK(mean_error(frames, known, 0, 96) < 0.8 * mean_error(frames, alone, 0, 96));
  CHECK(mean_error(frames, known, 96, 192) > 0.9 * mean_error(frames, alone, 96, 192));
}

TEST_CASE("fewer bytes and no less quality when the frames that follow are known") {
  const std::vector<Frame420> frames = half_still(15);
  const std::vector<uint8_t> alone = encode_clip(frames, options_of(frames, 8));
  const std::vector<uint8_t> known = encode_known_clip(frames, options_of(frames, 9.5));
  CHECK(known.size() < 0.97 * static_cast<double>(alone.size()));
  CHECK(mean_error(frames, decode_all(known), 0, 192) < mean_error(frames, decode_all(alone), 0, 192));
}

TEST_CASE("the decoder shows the reconstruction, whatever frames were said to follow") {
  for (const auto& [width, height] : {std::pair{1, 1}, {17, 33}, {99, 75}, {176, 144}})
    for (const Effort effort : {Effort::fast, Effort::normal, Effort::best}) {
      const std::vector<Frame420> frames = clip(width, height, 7), others = clip(width, height, 7, 5);
      mpeg1::SequenceOptions options = options_of(frames, 3);
      options.effort = effort;
      options.gop_length = 5;
      options.scene_cuts = true;
      auto encoder = mpeg1::Encoder::create(options);
      REQUIRE(encoder.ok());
      std::vector<uint8_t> bytes;
      std::vector<Frame420> shown;
      for (size_t i = 0; i < frames.size(); ++i) {
        const std::vector<const Frame420*> following = frames_after(others, i);  // and not these
        mpeg1::PictureOptions picture;
        picture.following = following;
        REQUIRE(encoder->add(frames[i], bytes, picture).ok());
        shown.push_back(mpeg1::copy_of(encoder->reconstruction()));
        if (i == 2) {
          REQUIRE(encoder->repeat(bytes).ok());
          shown.push_back(mpeg1::copy_of(encoder->reconstruction()));
        }
      }
      encoder->finish(bytes);
      mpeg1::DecoderOptions strict;
      strict.strict = true;
      const std::vector<Frame420> decoded = decode_all(bytes, strict);
      REQUIRE(decoded.size() == shown.size());
      for (size_t i = 0; i < decoded.size(); ++i) REQUIRE(equal(mpeg1::view_of(decoded[i]), mpeg1::view_of(shown[i])));
    }
}

TEST_CASE("bytes with known frames do not depend on the instruction set or the number of threads") {
  const std::vector<Frame420> frames = clip(176, 288, 4);
  for (const Effort effort : {Effort::fast, Effort::normal, Effort::best}) {
    mpeg1::SequenceOptions options = options_of(frames, 5);
    options.effort = effort;
    const std::vector<uint8_t> expected = encode_known_clip(frames, options, Isa::scalar);
    CHECK(expected != encode_clip(frames, options));
    for (const int threads : {1, 3}) {
      options.threads = threads;
      for (int i = 0; i < kIsaCount; ++i)
        if (kernels_for(static_cast<Isa>(i)) != nullptr)
          CHECK(encode_known_clip(frames, options, static_cast<Isa>(i)) == expected);
    }
  }
}

TEST_CASE("at a constant bit rate, too, what the group goes on showing has less error") {
  const std::vector<Frame420> frames = half_still(24);
  mpeg1::SequenceOptions options = options_of(frames, 4);
  options.gop_length = 12;
  options.bit_rate_bps = 250000;
  const std::vector<uint8_t> alone = encode_clip(frames, options), known = encode_known_clip(frames, options);
  CHECK(known.size() < 1.05 * static_cast<double>(alone.size()));
  CHECK(mean_error(frames, decode_all(known), 0, 96) < 0.8 * mean_error(frames, decode_all(alone), 0, 96));
}

TEST_CASE("frames that follow change nothing beside a quantizer of the picture's own or a map") {
  const std::vector<Frame420> frames = clip(80, 64, 6);
  const std::vector<uint8_t> map(20, 6);
  for (const bool has_map : {false, true}) {
    std::vector<uint8_t> bytes[2];
    for (const bool is_known : {false, true}) {
      auto encoder = mpeg1::Encoder::create(options_of(frames, 4));
      REQUIRE(encoder.ok());
      for (size_t i = 0; i < frames.size(); ++i) {
        const std::vector<const Frame420*> following = frames_after(frames, i);
        mpeg1::PictureOptions picture;
        if (is_known) picture.following = following;
        if (has_map)
          picture.quantizer_map = map;
        else
          picture.quantizer_scale = 6;
        REQUIRE(encoder->add(frames[i], bytes[is_known], picture).ok());
      }
    }
    CHECK(bytes[0] == bytes[1]);
  }
}

TEST_CASE("a frame that follows and has another size is refused, and nothing is written") {
  const std::vector<Frame420> frames = clip(80, 64, 1);
  const Frame420 other(64, 64);
  for (const Frame420* following : {&other, static_cast<const Frame420*>(nullptr)}) {
    auto encoder = mpeg1::Encoder::create(options_of(frames, 4));
    REQUIRE(encoder.ok());
    mpeg1::PictureOptions picture;
    picture.following = {&following, 1};
    std::vector<uint8_t> bytes;
    const auto report = encoder->add(frames[0], bytes, picture);
    REQUIRE(!report.ok());
    CHECK(report.failure().error == Error::bad_argument);
    CHECK(bytes.empty());
  }
}

}  // namespace
}  // namespace pac::test
