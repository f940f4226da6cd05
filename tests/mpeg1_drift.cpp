// 300 P pictures without an I picture in between: other decoders' transforms differ from ours by rounding, and what
// differs is predicted from again and again.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/mpeg1_clip.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

constexpr int kWidth = 64, kHeight = 48, kPictures = 301;

// One I picture, 300 P pictures; what the encoder believes decoders show.
struct LongStream {
  std::vector<uint8_t> bytes;
  std::vector<Frame420> shown;
};
LongStream long_stream(double quantizer) {
  mpeg1::SequenceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.quantizer_scale = quantizer;
  auto encoder = mpeg1::Encoder::create(options);
  REQUIRE(encoder.ok());
  LongStream stream;
  mpeg1::PictureOptions p;
  p.type = mpeg1::PictureType::P;
  for (int i = 0; i < kPictures; ++i) {
    REQUIRE(
        encoder->add(clip_frame(kWidth, kHeight, i % 120), stream.bytes, i == 0 ? mpeg1::PictureOptions() : p).ok());
    stream.shown.push_back(mpeg1::copy_of(encoder->reconstruction()));
  }
  encoder->finish(stream.bytes);
  return stream;
}

// The frames must be ours but for rounding errors, and no worse at the end than the accuracy of transforms explains.
void check_drift(const LongStream& stream, const std::vector<Frame420>& theirs) {
  REQUIRE(theirs.size() == stream.shown.size());
  double worst = 1000;
  for (size_t i = 0; i < theirs.size(); ++i)
    worst = std::min(worst, psnr(mpeg1::view_of(stream.shown[i]), mpeg1::view_of(theirs[i])));
  CHECK(worst > 50);  // 52.8 dB and more were measured
}

// mpeg2dec's PGM pictures: luma, below it Cb and Cr side by side.
std::vector<Frame420> libmpeg2_frames(const TempDir& dir) {
  REQUIRE(run("mpeg2dec -o pgmpipe " + dir.file("s.m1v") + " > " + dir.file("s.pgm")) == 0);
  const std::vector<uint8_t> bytes = read_bytes(dir.file("s.pgm"));
  const std::string head = "P5\n" + std::to_string(kWidth) + " " + std::to_string(kHeight * 3 / 2) + "\n255\n";
  const size_t size = head.size() + kWidth * kHeight * 3 / 2;
  std::vector<Frame420> frames;
  for (size_t at = 0; at + size <= bytes.size(); at += size) {
    REQUIRE(std::equal(head.begin(), head.end(), bytes.begin() + static_cast<ptrdiff_t>(at)));
    const uint8_t* samples = bytes.data() + at + head.size();
    Frame420 frame(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y, samples += kWidth) std::copy(samples, samples + kWidth, frame.y.row(y));
    for (int y = 0; y < kHeight / 2; ++y, samples += kWidth) {
      std::copy(samples, samples + kWidth / 2, frame.cb.row(y));
      std::copy(samples + kWidth / 2, samples + kWidth, frame.cr.row(y));
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

TEST_CASE("after 300 P pictures libavcodec and libmpeg2 still show what our encoder believes") {
  const bool has_ffmpeg = have_peer("ffmpeg"), has_mpeg2dec = have_peer("mpeg2dec");
  TempDir dir;
  for (const double quantizer : {1.0, 3.0, 10.0}) {
    CAPTURE(quantizer);
    const LongStream stream = long_stream(quantizer);
    write_bytes(dir.file("s.m1v"), stream.bytes);
    if (has_ffmpeg) check_drift(stream, ffmpeg_decodes(dir, dir.file("s.m1v")));
    if (has_mpeg2dec) check_drift(stream, libmpeg2_frames(dir));
  }
}

TEST_CASE("each macroblock is intra at least once in 132 pictures, also without I pictures") {
  mpeg1::SequenceOptions options;
  options.width = options.height = 16;
  auto encoder = mpeg1::Encoder::create(options);
  REQUIRE(encoder.ok());
  std::vector<uint8_t> bytes;
  mpeg1::PictureOptions p;
  p.type = mpeg1::PictureType::P;
  int predicted = 0;
  for (int i = 0; i < 300; ++i) {
    const auto report = encoder->add(clip_frame(16, 16, i), bytes, i == 0 ? mpeg1::PictureOptions() : p);
    REQUIRE(report.ok());
    predicted = report->type == mpeg1::PictureType::I || report->intra_macroblocks > 0 ? 0 : predicted + 1;
    REQUIRE(predicted < 132);
  }
}

}  // namespace
}  // namespace pac::test
