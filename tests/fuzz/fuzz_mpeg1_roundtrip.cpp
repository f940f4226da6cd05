// Any pictures and options: what we encode decodes, in strict mode, to the encoder's reconstruction.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "mpeg1/mpeg1.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

// Reads of a fuzzer's bytes: zeros past the end.
struct Bytes {
  const uint8_t* data;
  size_t size, at = 0;
  uint8_t next() { return at < size ? data[at++] : uint8_t{0}; }
};

void fill(pac::GrayImage& plane, Bytes& bytes) {
  for (int y = 0; y < plane.height(); ++y)
    for (int x = 0; x < plane.width(); ++x)
      plane.row(y)[x] = bytes.at < bytes.size ? bytes.next() : static_cast<uint8_t>(x * 5 + y * 3);
}

bool equal(const pac::PlaneView<const uint8_t>& a, const pac::PlaneView<const uint8_t>& b) {
  for (int y = 0; y < a.height; ++y)
    if (std::memcmp(a.row(y), b.row(y), static_cast<size_t>(a.width)) != 0) return false;
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes in{data, size};
  pac::mpeg1::SequenceOptions options;
  options.width = 1 + in.next() % 50;
  options.height = 1 + in.next() % 50;
  options.gop_length = 1 + in.next() % 4;
  options.quantizer_scale = 1 + in.next() % 61 / 2.0;
  options.effort = static_cast<pac::mpeg1::Effort>(in.next() % 3);
  options.slice_rows = in.next() % 3;
  const int entry = in.next() % 128;
  if (entry >= 3) {
    options.non_intra_matrix.emplace().fill(static_cast<uint8_t>(entry));
    options.intra_matrix.emplace().fill(static_cast<uint8_t>(entry));
    (*options.intra_matrix)[0] = 8;
  }
  if (in.next() % 4 == 0) options.bit_rate_bps = 20000 + 4000 * in.next();
  auto encoder = pac::mpeg1::Encoder::create(options);
  require(encoder.ok());
  pac::mpeg1::DecoderOptions strict;
  strict.strict = true;
  strict.low_delay = true;
  pac::mpeg1::Decoder decoder(strict);
  for (int i = 0; i < 3; ++i) {
    pac::Frame420 frame(options.width, options.height);
    fill(frame.y, in);
    fill(frame.cb, in);
    fill(frame.cr, in);
    std::vector<uint8_t> bytes;
    require(encoder->add(frame, bytes).ok());
    decoder.feed(bytes);
    decoder.end_picture();
    const auto picture = decoder.next();
    require(picture.ok() && *picture != nullptr);
    const auto& seen = (*picture)->view;
    const auto expected = encoder->reconstruction();
    require(equal(seen.y, expected.y) && equal(seen.cb, expected.cb) && equal(seen.cr, expected.cr));
  }
  return 0;
}
