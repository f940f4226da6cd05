// PNG reader: any bytes give a picture or a failure inside them; what decodes is written and decodes again to the same.
// Checksums would stop nearly every mutation at the door, so each input is tried three times: as it is, with the CRCs
// of its chunks put right, and as the contents of a file (header fields, palette, transparency, filtered rows) built
// around it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "base/checksum.h"
#include "base/deflate.h"
#include "base/image_io.h"

namespace {

using Bytes = std::span<const uint8_t>;

void check(Bytes bytes) {
  pac::Limits limits;
  limits.max_pixels = 1 << 20;
  limits.max_bytes = 1 << 24;
  const auto rgba = pac::decode_png_rgba(bytes, limits);
  const auto rgb = pac::decode_png_rgb(bytes, limits);
  const auto gray = pac::decode_png_gray(bytes, limits);
  PAC_ASSERT(rgba.ok() == rgb.ok());
  if (gray.ok()) PAC_ASSERT(rgb.ok());
  if (!rgba.ok()) {
    PAC_ASSERT(rgba.failure().byte_offset <= bytes.size() && rgba.failure().text[0] != 0);
    return;
  }
  PAC_ASSERT(pac::read_image_info(bytes).ok());
  if (rgba->width() * rgba->height() > 4096) return;
  const auto again = pac::decode_png_rgba(pac::encode_png(rgba->view()), limits);
  PAC_ASSERT(again.ok() && again->width() == rgba->width() && again->height() == rgba->height());
  const auto row_bytes = static_cast<size_t>(rgba->width()) * 4;
  for (int y = 0; y < rgba->height(); ++y) PAC_ASSERT(std::memcmp(again->row(y), rgba->row(y), row_bytes) == 0);
}

void put_u32(uint8_t* to, uint32_t value) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<uint8_t>(value >> (24 - 8 * i));
}

std::vector<uint8_t> with_right_checksums(Bytes bytes) {
  std::vector<uint8_t> file(bytes.begin(), bytes.end());
  for (size_t at = 8; at + 12 <= file.size();) {
    const size_t length =
        size_t{file[at]} << 24 | size_t{file[at + 1]} << 16 | size_t{file[at + 2]} << 8 | file[at + 3];
    if (length > file.size() - at - 12) break;
    put_u32(&file[at + 8 + length], pac::crc32(Bytes(file).subspan(at + 4, length + 4)));
    at += 12 + length;
  }
  return file;
}

void append_chunk(std::vector<uint8_t>& file, std::string_view type, Bytes data) {
  const size_t at = file.size();
  file.resize(at + 12 + data.size());
  put_u32(&file[at], static_cast<uint32_t>(data.size()));
  std::copy(type.begin(), type.end(), file.begin() + static_cast<ptrdiff_t>(at) + 4);
  std::copy(data.begin(), data.end(), file.begin() + static_cast<ptrdiff_t>(at) + 8);
  put_u32(&file[at + 8 + data.size()], pac::crc32(Bytes(file).subspan(at + 4, data.size() + 4)));
}

// Bytes: width, height (one each), depth, color type, interlace, sizes of palette and transparency; then those two;
// then the rows.
std::vector<uint8_t> built_around(Bytes bytes) {
  std::vector<uint8_t> file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  if (bytes.size() < 7) return file;
  const uint8_t header[13] = {0, 0, 0, bytes[0], 0, 0, 0, bytes[1], bytes[2], bytes[3], 0, 0, bytes[4]};
  append_chunk(file, "IHDR", header);
  Bytes rest = bytes.subspan(7);
  const Bytes palette = rest.first(std::min<size_t>(rest.size(), bytes[5] * 3u));
  rest = rest.subspan(palette.size());
  const Bytes transparency = rest.first(std::min<size_t>(rest.size(), bytes[6]));
  rest = rest.subspan(transparency.size());
  if (!palette.empty()) append_chunk(file, "PLTE", palette);
  if (!transparency.empty()) append_chunk(file, "tRNS", transparency);
  append_chunk(file, "IDAT", pac::deflate_zlib(rest));
  append_chunk(file, "IEND", {});
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const Bytes bytes(data, size);
  check(bytes);
  check(with_right_checksums(bytes));
  check(built_around(bytes));
  return 0;
}
