// Constant bit rate: the size, the decoder's buffer, the picture types.
#include <doctest/doctest.h>

#include <tuple>
#include <vector>

#include "mpeg1/headers.h"
#include "mpeg1/system.h"
#include "tests/support/mpeg1_clip.h"

namespace pac::test {
namespace {

using mpeg1::PictureType;

// Bits of a picture with its headers and zeros, and what its header says of the buffer.
struct Sent {
  double bits = 0, header_bits = 0;
  int vbv_delay = 0;
};

Sent measure(const std::vector<uint8_t>& bytes) {
  Sent sent;
  sent.bits = 8.0 * static_cast<double>(bytes.size());
  for (size_t at = 0; at + 4 < bytes.size(); ++at) {
    if (bytes[at] != 0 || bytes[at + 1] != 0 || bytes[at + 2] != 1 || bytes[at + 3] != 0) continue;
    sent.header_bits = 8.0 * static_cast<double>(at);
    sent.vbv_delay = mpeg1::parse_picture_header(std::span(bytes).subspan(at + 4))->vbv_delay;
    break;
  }
  return sent;
}

TEST_CASE(
    "at a constant bit rate the decoder's buffer neither runs empty nor over, and vbv_delay says how full it is") {
  const int n_frames = 40;
  for (const auto& [rate, seed, is_known] :
       {std::tuple{200000, 1, false}, {600000, 2, false}, {3000000, 3, false}, {200000, 1, true}, {600000, 2, true}}) {
    std::vector<Frame420> frames;  // half way another scene
    for (int i = 0; i < n_frames; ++i) frames.push_back(clip_frame(176, 144, i, i < n_frames / 2 ? seed : seed + 5));
    mpeg1::SequenceOptions options;
    options.width = 176;
    options.height = 144;
    options.bit_rate_bps = rate;
    options.gop_length = 12;
    auto encoder = mpeg1::Encoder::create(options);
    REQUIRE(encoder.ok());
    double fullness = -1, total = 0;
    double buffer = 0;
    for (int i = 0; i < n_frames; ++i) {
      std::vector<uint8_t> bytes;
      const std::vector<const Frame420*> following = frames_after(frames, static_cast<size_t>(i));
      mpeg1::PictureOptions picture;
      if (is_known) picture.following = following;
      REQUIRE(encoder->add(frames[static_cast<size_t>(i)], bytes, picture).ok());
      const Sent sent = measure(bytes);
      if (i == 0) {
        buffer = 16384.0 * mpeg1::read_info(bytes)->sequence.vbv_buffer_size;
        fullness = sent.vbv_delay * static_cast<double>(rate) / 90000 + sent.header_bits;
      }
      // A tick of the delay is rate / 90000 bits.
      CHECK(std::abs(fullness - sent.header_bits - sent.vbv_delay * static_cast<double>(rate) / 90000) <
            2.0 * rate / 90000 + 16);
      CHECK(fullness <= buffer);
      fullness -= sent.bits;
      CHECK(fullness >= 0);
      fullness += rate / 30.0;
      total += sent.bits;
    }
    CHECK(total < 1.25 * rate * n_frames / 30 + buffer);
    CHECK(total > 0.5 * rate * n_frames / 30);
  }
}

TEST_CASE("constrained_parameters_flag is set where it is true, and only there") {
  const auto flag = [](int width, int height, int64_t rate) {
    mpeg1::SequenceOptions options;
    options.width = width;
    options.height = height;
    options.bit_rate_bps = rate;
    options.picture_rate_code = 3;
    return mpeg1::read_info(encode_clip(clip(width, height, 1), options))->sequence.constrained_parameters;
  };
  CHECK(flag(352, 288, 1150000));
  CHECK_FALSE(flag(352, 288, 2000000));
  CHECK_FALSE(flag(640, 480, 1150000));
  CHECK_FALSE(flag(352, 288, 0));
}

TEST_CASE("a scene cut becomes an I picture where that is asked for") {
  mpeg1::SequenceOptions options;
  options.width = 96;
  options.height = 64;
  for (const bool wanted : {false, true}) {
    options.scene_cuts = wanted;
    auto encoder = mpeg1::Encoder::create(options);
    std::vector<uint8_t> bytes;
    for (int i = 0; i < 3; ++i)
      REQUIRE(encoder->add(clip_frame(96, 64, i, 1), bytes)->type == (i == 0 ? PictureType::I : PictureType::P));
    Frame420 other = clip_frame(96, 64, 0, 9);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) other.y.row(y)[x] = static_cast<uint8_t>(255 - other.y.row(y)[x] / 4);
    CHECK(encoder->add(other, bytes)->type == (wanted ? PictureType::I : PictureType::P));
  }
}

TEST_CASE("without I pictures every macroblock is intra at least once in 132 codings") {
  mpeg1::SequenceOptions options;
  options.width = 64;
  options.height = 48;
  options.quantizer_scale = 1;
  auto encoder = mpeg1::Encoder::create(options);
  std::vector<uint8_t> bytes;
  int intra = 0, most_at_once = 0;
  for (int i = 0; i < 270; ++i) {
    mpeg1::PictureOptions picture;
    picture.type = PictureType::P;
    // Noise that no vector finds, small enough that prediction pays.
    const auto report = encoder->add(clip_frame(64, 48, i / 2, 1), bytes, picture);
    REQUIRE(report.ok());
    if (i == 0) continue;
    CHECK(report->type == PictureType::P);
    intra += report->intra_macroblocks;
    most_at_once = std::max(most_at_once, report->intra_macroblocks);
  }
  CHECK(intra >= 12);
  CHECK(most_at_once <= 12);
}

}  // namespace
}  // namespace pac::test
