// Any picture in any pixel format, sampling, as rows or planes, in streams: one picture, one file, and it decodes.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "base/hash.h"
#include "jpeg/abbreviated.h"
#include "jpeg/metadata.h"
#include "jpeg/pixel_io.h"

namespace {

using namespace pac::jpeg;

void require(bool condition) {
  if (!condition) std::abort();
}

// Reads of a fuzzer's bytes: zeros past the end.
struct Bytes {
  const uint8_t* data;
  size_t size, at = 0;
  int next() { return at < size ? data[at++] : 0; }
};

EncodeOptions options_from(Bytes& bytes) {
  EncodeOptions options = options_for(static_cast<Effort>(bytes.next() % 3), static_cast<Tune>(bytes.next() % 3),
                                      (bytes.next() + 1) * 100.0 / 256.0);
  SamplingFactors factors;
  for (size_t i = 0; i < 3; ++i) {
    const int pair = bytes.next();
    factors.h[i] = static_cast<uint8_t>(1 + (pair & 3));
    factors.v[i] = static_cast<uint8_t>(1 + (pair >> 2 & 3));
  }
  options.sampling = factors;
  options.restart_interval_mcus = bytes.next() % 8;
  return options;
}

void check_planes(const std::vector<uint8_t>& file, const EncodeOptions& options) {
  const auto planes = decode_planes(file);
  require(planes.ok() && planes->planes.size() == 3);
  const auto view = [&](size_t i) {
    const SamplePlane& plane = planes->planes[i];
    return pac::PlaneView<const uint8_t>{plane.samples.data(), plane.width, plane.height, plane.width};
  };
  const auto again = encode_planes({planes->width, planes->height, view(0), view(1), view(2)}, options);
  require(again.ok() && decode(*again).ok());
}

void check_stream(pac::ConstRgbView image, EncodeOptions options) {
  const pac::ConstRgbView pictures[] = {image};
  const auto tables = StreamTables::for_pictures(pictures, options);
  require(tables.ok());
  StreamDecoder decoder;
  require(decoder.read_tables(tables->file()).ok());
  options.stream = &*tables;
  const auto part = encode(image, options);
  require(part.ok() && decoder.decode(*part).ok());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes bytes{data, size};
  const int width = 1 + bytes.next() % 40, height = 1 + bytes.next() % 40;
  EncodeOptions options = options_from(bytes);
  const auto format = static_cast<PixelFormat>(bytes.next() % 6);
  const int n = bytes_per_pixel(format), row_bytes = width * n;
  std::vector<uint8_t> pixels(static_cast<size_t>(row_bytes) * static_cast<size_t>(height));
  int previous = 128;
  for (uint8_t& sample : pixels) sample = static_cast<uint8_t>(previous = (previous + bytes.next()) & 255);
  const auto file = encode_pixels({pixels.data(), width, height, row_bytes, format}, options);
  int n_blocks = 0;
  for (size_t i = 0; i < 3; ++i) n_blocks += options.sampling->h[i] * options.sampling->v[i];
  require(file.ok() == (n_blocks <= 10));
  if (!file.ok()) return 0;
  require(file->size() <= encode_bound(width, height, *options.sampling, options.restart_interval_mcus));

  const auto rows = encode_rows(
      width, height, format,
      [&](int y, std::span<uint8_t> row) {
        std::memcpy(row.data(), pixels.data() + static_cast<size_t>(y) * row.size(), row.size());
        return true;
      },
      options);
  require(rows.ok() && *rows == *file);
  options.isa = pac::Isa::scalar;
  require(*encode_pixels({pixels.data(), width, height, row_bytes, format}, options) == *file);
  const auto decoded = decode(*file);
  require(decoded.ok() && decoded->width() == width && decoded->height() == height);
  check_planes(*file, options);
  check_stream(decoded->view(), options);
  return 0;
}
