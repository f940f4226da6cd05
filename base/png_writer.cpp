// PNG encoder: pixels -> filtered rows -> zlib stream -> chunks.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "base/checksum.h"
#include "base/deflate.h"
#include "base/png.h"
#include "base/png_filter.h"

namespace pac {
namespace {

constexpr uint8_t kSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

void put_u32(std::vector<uint8_t>& out, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(value >> shift));
}

// Length, type, data, CRC over type and data [PNG 5.3].
void put_chunk(std::vector<uint8_t>& out, const char type[5], std::span<const uint8_t> data) {
  put_u32(out, static_cast<uint32_t>(data.size()));
  const size_t start = out.size();
  out.insert(out.end(), type, type + 4);
  out.insert(out.end(), data.begin(), data.end());
  put_u32(out, crc32(std::span<const uint8_t>(out).subspan(start)));
}

// Bytes taken as signed: residuals near zero in either direction compress well [PNG 12.7, adaptive filtering].
uint64_t sum_of_absolutes(const uint8_t* bytes, size_t n) {
  uint64_t total = 0;
  for (size_t start = 0; start < n; start += 1 << 16) {  // 32 bits hold 2^16 * 128
    uint32_t sum = 0;
    for (size_t i = start; i < std::min(n, start + (1 << 16)); ++i)
      sum += std::min<uint32_t>(bytes[i], 256u - bytes[i]);
    total += sum;
  }
  return total;
}

template <int kChannels>
std::vector<uint8_t> filter_rows(ImageView<const uint8_t, kChannels> image) {
  const size_t n = static_cast<size_t>(image.width) * kChannels;
  std::vector<uint8_t> rows;
  rows.reserve((n + 1) * static_cast<size_t>(image.height));
  const std::vector<uint8_t> zeros(n, 0);
  std::vector<uint8_t> best(n), trial(n);
  const uint8_t* above = zeros.data();
  for (int y = 0; y < image.height; ++y) {
    const uint8_t* row = image.row(y);
    uint64_t best_cost = UINT64_MAX;
    auto best_filter = PngFilter::none;
    for (int f = 0; f < kPngFilterCount; ++f) {
      filter_png_row(static_cast<PngFilter>(f), row, above, n, kChannels, trial.data());
      const uint64_t cost = sum_of_absolutes(trial.data(), n);
      if (cost >= best_cost) continue;
      best_cost = cost;
      best_filter = static_cast<PngFilter>(f);
      best.swap(trial);
    }
    rows.push_back(static_cast<uint8_t>(best_filter));
    rows.insert(rows.end(), best.begin(), best.end());
    above = row;
  }
  return rows;
}

template <int kChannels>
std::vector<uint8_t> encode(ImageView<const uint8_t, kChannels> image, PngHeader::ColorType color_type) {
  PAC_ASSERT(!image.empty());
  std::vector<uint8_t> header;
  put_u32(header, static_cast<uint32_t>(image.width));
  put_u32(header, static_cast<uint32_t>(image.height));
  header.insert(header.end(), {8, color_type, 0, 0, 0});
  const std::vector<uint8_t> data = deflate_zlib(filter_rows(image));
  std::vector<uint8_t> out(std::begin(kSignature), std::end(kSignature));
  out.reserve(data.size() + data.size() / 1024 + 128);
  put_chunk(out, "IHDR", header);
  constexpr size_t kMaxChunk = size_t{1} << 20;  // readers may hold one chunk at a time
  for (size_t at = 0; at < data.size(); at += kMaxChunk)
    put_chunk(out, "IDAT", std::span(data).subspan(at, std::min(kMaxChunk, data.size() - at)));
  put_chunk(out, "IEND", {});
  return out;
}

}  // namespace

std::vector<uint8_t> encode_png(ConstRgbView image) {
  return encode(image, PngHeader::rgb);
}
std::vector<uint8_t> encode_png(ConstRgbaView image) {
  return encode(image, PngHeader::rgba);
}
std::vector<uint8_t> encode_png(PlaneView<const uint8_t> image) {
  return encode(image, PngHeader::gray);
}

}  // namespace pac
