// Any bytes as a JPEG file: its coefficients written again decode to the same pixels, its metadata pass on, its tables
// stay in a stream.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "base/hash.h"
#include "jpeg/abbreviated.h"
#include "jpeg/coefficient_io.h"
#include "jpeg/metadata.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

uint64_t pixels_of(std::span<const uint8_t> file, const pac::jpeg::DecodeOptions& options) {
  const auto image = pac::jpeg::decode(file, options);
  require(image.ok());
  return pac::hash_pixels(image->view());
}

void check_coefficients(std::span<const uint8_t> bytes, const pac::jpeg::DecodeOptions& options, bool is_sound) {
  auto read = pac::jpeg::read_coefficients(bytes, options, true);
  if (!read.ok()) return;
  const int restart = static_cast<int>(bytes.size() % 5);
  const auto huffman = bytes.size() % 2 == 0 ? pac::jpeg::Huffman::standard : pac::jpeg::Huffman::optimal;
  const auto file = pac::jpeg::write_coefficients(read->image, {huffman, restart, nullptr});
  // Refused: coefficients beyond what baseline files hold.
  if (file.ok() && is_sound) require(pixels_of(*file, options) == pixels_of(bytes, options));
  if (file.ok()) {
    const auto again = pac::jpeg::read_coefficients(*file, options);
    require(again.ok());
    if (!pac::jpeg::write_coefficients(again->image, {huffman, restart, nullptr}).ok()) std::abort();
  }
  if (read->image.components.size() != 4) pac::jpeg::requantize(read->image, pac::jpeg::annex_k_tables(50));
  const auto coarser = pac::jpeg::write_coefficients(read->image);
  if (coarser.ok()) pixels_of(*coarser, options);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  pac::jpeg::DecodeOptions options;
  options.limits.max_pixels = 1 << 14;
  options.limits.max_bytes = 1 << 21;
  const auto strict = pac::jpeg::decode(bytes, options);
  require(pac::jpeg::read_coefficients(bytes, options).ok() == strict.ok());
  check_coefficients(bytes, options, strict.ok());

  const auto found = pac::jpeg::read_metadata(bytes, options.limits);
  if (found.ok()) {
    const auto merged = pac::jpeg::with_metadata(bytes, found->metadata, options.limits);
    require(merged.ok());
    const auto again = pac::jpeg::read_metadata(*merged, options.limits);
    require(again.ok());
    if (strict.ok()) require(pixels_of(*merged, options) == pac::hash_pixels(strict->view()));
  }

  pac::jpeg::StreamDecoder stream(options);
  const bool has_tables = stream.read_tables(bytes).ok();
  const auto image = stream.decode(bytes);
  require(image.ok() == strict.ok() || has_tables);
  if (image.ok() && !has_tables) require(pac::hash_pixels(image->view()) == pac::hash_pixels(strict->view()));
  return 0;
}
