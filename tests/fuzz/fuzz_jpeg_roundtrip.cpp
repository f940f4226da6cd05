// Any picture and options: what we encode is sound, within its bound, the same on every instruction set, and decodes.
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "base/hash.h"
#include "jpeg/jpeg.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

// Reads of a fuzzer's bytes: zeros past the end.
struct Bytes {
  const uint8_t* data;
  size_t size, at = 0;
  int next() { return at < size ? data[at++] : 0; }
};

pac::jpeg::EncodeOptions options_from(Bytes& bytes) {
  using namespace pac::jpeg;
  EncodeOptions options;
  options.quality = (bytes.next() + 1) * 100.0 / 256.0;
  options.subsampling = static_cast<Subsampling>(bytes.next() & 3);
  options.tune = static_cast<Tune>(bytes.next() % 3);
  const int flags = bytes.next();
  options.huffman = (flags & 1) != 0 ? Huffman::optimal : Huffman::standard;
  options.trellis = (flags & 2) != 0;
  options.table_source = (flags & 4) != 0 ? TableSource::tuned : TableSource::annex_k;
  if ((flags & 24) == 24) options.table_source = TableSource::adapted;
  options.restart_interval_mcus = (flags & 32) != 0 ? bytes.next() : 0;
  options.dead_zone = bytes.next() * 0.49 / 255.0;
  if ((flags & 64) != 0) {
    QuantTables tables;
    for (size_t i = 0; i < 64; ++i) {
      tables.luma[i] = static_cast<uint16_t>(1 + bytes.next() % 255);
      tables.chroma[i] = static_cast<uint16_t>(256 - tables.luma[i]);
    }
    options.tables = tables;
  }
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes bytes{data, size};
  const int width = 1 + bytes.next() % 40, height = 1 + bytes.next() % 40;
  pac::jpeg::EncodeOptions options = options_from(bytes);
  pac::RgbImage image(width, height);
  int previous = 128;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 3 * width; ++x)
      image.row(y)[x] = static_cast<uint8_t>(previous = (previous + bytes.next()) & 255);

  const auto file = pac::jpeg::encode(image.view(), options);
  require(file.ok());
  const uint64_t bound = pac::jpeg::encode_bound(width, height, options.subsampling, options.restart_interval_mcus);
  require(file->size() <= bound);
  options.isa = pac::Isa::scalar;
  std::vector<uint8_t> buffer(file->size());
  require(pac::jpeg::encode_into(image.view(), options, buffer).ok() && buffer == *file);
  const auto decoded = pac::jpeg::decode(*file);
  require(decoded.ok() && decoded->width() == width && decoded->height() == height);
  require(pac::hash_pixels(pac::jpeg::decode(*file, {}, pac::Isa::scalar)->view()) ==
          pac::hash_pixels(decoded->view()));
  return 0;
}
