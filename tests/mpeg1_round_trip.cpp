// What the encoder reconstructs is what the decoder shows, whatever the options.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/kernels/kernels.h"
#include "tests/support/mpeg1_clip.h"

namespace pac::test {
namespace {

using mpeg1::Effort;
using mpeg1::PictureType;

// Encodes and decodes in strict mode; every picture equal, and near the source.
void require_round_trip(const std::vector<Frame420>& frames, const mpeg1::SequenceOptions& options, double least_db) {
  auto encoder = mpeg1::Encoder::create(options);
  REQUIRE(encoder.ok());
  std::vector<uint8_t> bytes;
  std::vector<Frame420> reconstructions;
  for (const Frame420& frame : frames) {
    const auto report = encoder->add(frame, bytes);
    REQUIRE(report.ok());
    reconstructions.push_back(mpeg1::copy_of(encoder->reconstruction()));
    CHECK(psnr(mpeg1::view_of(frame), encoder->reconstruction()) > least_db);
  }
  encoder->finish(bytes);
  mpeg1::DecoderOptions strict;
  strict.strict = true;
  const std::vector<Frame420> decoded = decode_all(bytes, strict);
  REQUIRE(decoded.size() == frames.size());
  for (size_t i = 0; i < decoded.size(); ++i)
    REQUIRE(equal(mpeg1::view_of(decoded[i]), mpeg1::view_of(reconstructions[i])));
}

TEST_CASE("the decoder shows the encoder's reconstruction at every size, effort and slice height") {
  for (const auto& [width, height] : {std::pair{1, 1}, {16, 16}, {17, 33}, {64, 48}, {99, 75}, {176, 144}})
    for (const Effort effort : {Effort::fast, Effort::normal, Effort::best})
      for (const int slice_rows : {0, 1, 2}) {
        CAPTURE(slice_rows);
        mpeg1::SequenceOptions options;
        options.width = width;
        options.height = height;
        options.effort = effort;
        options.slice_rows = slice_rows;
        options.gop_length = 5;
        options.quantizer_scale = 3;
        require_round_trip(clip(width, height, 7), options, 30);
      }
}

TEST_CASE("every quantizer_scale, and those between integers") {
  const std::vector<Frame420> frames = clip(80, 64, 4);
  for (const double q : {1.0, 1.5, 2.0, 6.25, 12.0, 30.5, 31.0}) {
    CAPTURE(q);
    mpeg1::SequenceOptions options;
    options.width = 80;
    options.height = 64;
    options.quantizer_scale = q;
    require_round_trip(frames, options, q < 2 ? 40 : 20);
  }
}

TEST_CASE("matrices below 16 quantize finer than quantizer_scale 1 does") {
  const std::vector<Frame420> frames = clip(80, 64, 4);
  mpeg1::SequenceOptions options;
  options.width = 80;
  options.height = 64;
  options.quantizer_scale = 1;
  options.intra_matrix.emplace().fill(4);
  (*options.intra_matrix)[0] = 8;
  options.non_intra_matrix.emplace().fill(4);
  require_round_trip(frames, options, 50);
}

TEST_CASE("a quantizer_scale below 1 gives more quality than 1, down to its limit") {
  const std::vector<Frame420> frames = clip(80, 64, 4);
  for (const Effort effort : {Effort::fast, Effort::normal, Effort::best})
    for (const double q : {mpeg1::kLeastQuantizerScale, 0.5}) {
      CAPTURE(q);
      mpeg1::SequenceOptions options;
      options.width = 80;
      options.height = 64;
      options.effort = effort;
      options.quantizer_scale = q;
      require_round_trip(frames, options, q < 0.4 ? 50 : 49);
    }
  mpeg1::SequenceOptions too_fine;
  too_fine.width = too_fine.height = 16;
  too_fine.quantizer_scale = 0.1;
  CHECK(!mpeg1::Encoder::create(too_fine).ok());
}

TEST_CASE("efforts above fast send an intra matrix nearer to flat, unless the caller has one or pictures are small") {
  const auto sent = [](Effort effort, int width, bool has_own) {
    mpeg1::SequenceOptions options;
    options.width = width;
    options.height = 240;
    options.effort = effort;
    if (has_own) options.intra_matrix = mpeg1::kDefaultIntraMatrix;
    mpeg1::Decoder decoder;
    decoder.feed(encode_clip(clip(width, 240, 1), options));
    REQUIRE(decoder.next().ok());
    REQUIRE(decoder.sequence() != nullptr);
    return decoder.sequence()->intra_matrix;
  };
  for (const Effort effort : {Effort::normal, Effort::best}) {
    const mpeg1::QuantizerMatrix matrix = sent(effort, 320, false);
    CHECK(matrix[0] == 8);
    CHECK(matrix[1] > mpeg1::kDefaultIntraMatrix[1]);
    CHECK(matrix[63] < mpeg1::kDefaultIntraMatrix[63]);
    CHECK(sent(effort, 320, true) == mpeg1::kDefaultIntraMatrix);
    CHECK(sent(effort, 160, false) == mpeg1::kDefaultIntraMatrix);
  }
  CHECK(sent(Effort::fast, 320, false) == mpeg1::kDefaultIntraMatrix);
}

TEST_CASE("an intra matrix nearer to flat comes back as it was coded, on every instruction set") {
  const std::vector<Frame420> frames = clip(320, 240, 4);
  for (const Effort effort : {Effort::normal, Effort::best}) {
    mpeg1::SequenceOptions options;
    options.width = 320;
    options.height = 240;
    options.effort = effort;
    require_round_trip(frames, options, 36);
    const std::vector<uint8_t> expected = encode_clip(frames, options, Isa::scalar);
    for (int i = 0; i < kIsaCount; ++i)
      if (kernels_for(static_cast<Isa>(i)) != nullptr)
        CHECK(encode_clip(frames, options, static_cast<Isa>(i)) == expected);
  }
}

TEST_CASE("matrices that adapt to the groups before reach the decoder with the next sequence header") {
  const std::vector<Frame420> frames = clip(176, 144, 24);
  for (const Effort effort : {Effort::normal, Effort::best})
    for (const double q : {1.0, 6.0}) {
      CAPTURE(q);
      mpeg1::SequenceOptions options;
      options.width = 176;
      options.height = 144;
      options.effort = effort;
      options.gop_length = 8;
      options.quantizer_scale = q;
      options.adapt_matrices = true;
      require_round_trip(frames, options, q < 2 ? 47 : 37);
    }
}

TEST_CASE("bytes do not depend on the instruction set or the number of threads") {
  const std::vector<Frame420> frames = clip(176, 288, 4);
  for (const Effort effort : {Effort::fast, Effort::normal, Effort::best}) {
    mpeg1::SequenceOptions options;
    options.width = 176;
    options.height = 288;
    options.effort = effort;
    const std::vector<uint8_t> expected = encode_clip(frames, options, Isa::scalar);
    for (const int threads : {1, 2, 3}) {
      options.threads = threads;
      for (int i = 0; i < kIsaCount; ++i)
        if (kernels_for(static_cast<Isa>(i)) != nullptr)
          CHECK(encode_clip(frames, options, static_cast<Isa>(i)) == expected);
    }
  }
}

TEST_CASE("a repeated picture is skipped macroblocks in a few bytes") {
  const std::vector<Frame420> frames = clip(320, 240, 1);
  mpeg1::SequenceOptions options;
  options.width = 320;
  options.height = 240;
  auto encoder = mpeg1::Encoder::create(options);
  std::vector<uint8_t> bytes;
  REQUIRE(encoder->add(frames[0], bytes).ok());
  const auto report = encoder->repeat(bytes);
  REQUIRE(report.ok());
  CHECK(report->size_bytes < 60);
  encoder->finish(bytes);
  const std::vector<Frame420> decoded = decode_all(bytes);
  REQUIRE(decoded.size() == 2);
  CHECK(equal(mpeg1::view_of(decoded[0]), mpeg1::view_of(decoded[1])));
}

TEST_CASE("a picture predicted from the caller's reference decodes with the same reference, and only with it") {
  const std::vector<Frame420> frames = clip(96, 80, 3);
  mpeg1::SequenceOptions options;
  options.width = 96;
  options.height = 80;
  options.quantizer_scale = 8;
  auto encoder = mpeg1::Encoder::create(options);
  std::vector<uint8_t> bytes;
  REQUIRE(encoder->add(frames[0], bytes).ok());
  mpeg1::PictureOptions picture;
  picture.reference = &frames[2];
  const auto report = encoder->add(frames[2], bytes, picture);
  REQUIRE(report.ok());
  CHECK(report->type == PictureType::P);
  CHECK(report->coded_macroblocks + report->intra_macroblocks < 4);  // a perfect prediction
  encoder->finish(bytes);

  mpeg1::DecoderOptions with;
  with.reference = [](void* context, const mpeg1::PictureHeader&, const mpeg1::FrameView&) {
    return static_cast<const Frame420*>(context);
  };
  with.reference_context = const_cast<Frame420*>(&frames[2]);
  CHECK(equal(mpeg1::view_of(decode_all(bytes, with)[1]), encoder->reconstruction()));
  CHECK_FALSE(equal(mpeg1::view_of(decode_all(bytes)[1]), encoder->reconstruction()));
}

TEST_CASE(
    "where noise is all that a replaced reference lacks, the picture is skipped, whatever matches the noise better") {
  Frame420 frame(160, 128), reference(160, 128);
  uint32_t state = 1;
  for (Frame420* to : {&frame, &reference})
    for (GrayImage* plane : {&to->y, &to->cb, &to->cr})
      for (int y = 0; y < plane->height(); ++y)
        for (int x = 0; x < plane->width(); ++x) {
          state = state * 1664525u + 1013904223u;
          plane->row(y)[x] = static_cast<uint8_t>(126 + (state >> 16) % 5);
        }
  for (const Effort effort : {Effort::normal, Effort::best}) {
    mpeg1::SequenceOptions options;
    options.width = 160;
    options.height = 128;
    options.effort = effort;
    auto encoder = mpeg1::Encoder::create(options);
    mpeg1::PictureOptions picture;
    picture.type = PictureType::P;
    picture.reference = &reference;
    picture.quantizer_scale = 16;
    std::vector<uint8_t> bytes;
    const auto report = encoder->add(frame, bytes, picture);
    REQUIRE(report.ok());
    CHECK(report->size_bytes < 40);
  }
}

TEST_CASE("the caller's candidates lead the search to a motion it would not find") {
  std::vector<Frame420> frames;
  for (const int time : {0, 30}) frames.push_back(clip_frame(320, 64, time));  // 60 samples to the left
  mpeg1::SequenceOptions options;
  options.width = 320;
  options.height = 64;
  options.effort = Effort::fast;
  uint64_t sizes[2];
  for (const int with : {0, 1}) {
    auto encoder = mpeg1::Encoder::create(options);
    std::vector<uint8_t> bytes;
    REQUIRE(encoder->add(frames[0], bytes).ok());
    mpeg1::PictureOptions picture;
    const std::vector<mpeg1::MotionVector> vectors(20 * 4, {120, 30});
    if (with != 0) {
      picture.candidates = vectors;
      picture.candidates_per_macroblock = 1;
    }
    sizes[with] = encoder->add(frames[1], bytes, picture)->size_bytes;
  }
  CHECK(sizes[1] < sizes[0]);
}

}  // namespace
}  // namespace pac::test
