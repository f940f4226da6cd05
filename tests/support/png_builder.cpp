#include "tests/support/png_builder.h"

#include <algorithm>
#include <cstdlib>

#include "base/checksum.h"
#include "base/deflate.h"
#include "tests/support/generators.h"

namespace pac::test {
namespace {

void put_u32(Bytes& out, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(value >> shift));
}

// One row of packed samples of the pixels x0, x0 + dx, ... at y.
Bytes pack_row(const PngSpec& spec, int x0, int dx, int y) {
  Bytes row;
  int n_bits = 0;
  for (int x = x0; x < spec.width; x += dx) {
    for (int c = 0; c < channels_of(spec.color_type); ++c) {
      const int sample = sample_of(spec, x, y, c);
      for (int bit = spec.bit_depth - 1; bit >= 0; --bit, ++n_bits) {
        if (n_bits % 8 == 0) row.push_back(0);
        row.back() = static_cast<uint8_t>(row.back() | (sample >> bit & 1) << (7 - n_bits % 8));
      }
    }
  }
  return row;
}

int paeth(int a, int b, int c) {
  const int p = a + b - c;
  const int pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

void append_filtered(Bytes& out, int filter, const Bytes& row, const Bytes& above, size_t distance) {
  out.push_back(static_cast<uint8_t>(filter));
  for (size_t i = 0; i < row.size(); ++i) {
    const int a = i >= distance ? row[i - distance] : 0, b = above[i], c = i >= distance ? above[i - distance] : 0;
    const int predictions[5] = {0, a, b, (a + b) / 2, paeth(a, b, c)};
    out.push_back(static_cast<uint8_t>(row[i] - predictions[filter]));
  }
}

}  // namespace

int channels_of(int color_type) {
  return color_type == 2 ? 3 : color_type == 4 ? 2 : color_type == 6 ? 4 : 1;
}

int sample_of(const PngSpec& spec, int x, int y, int c) {
  if (spec.sample) return spec.sample(x, y, c);
  Random random(static_cast<uint64_t>(x * 1000003 + y * 1009 + c));
  const int max = spec.color_type == 3 && !spec.palette.empty() ? static_cast<int>(spec.palette.size() / 3) - 1
                                                                : (1 << spec.bit_depth) - 1;
  return static_cast<int>(random.in(0, max));
}

Bytes png_signature() {
  return {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
}

Bytes png_chunk(std::string_view type, std::span<const uint8_t> data) {
  Bytes chunk;
  put_u32(chunk, static_cast<uint32_t>(data.size()));
  for (char letter : type) chunk.push_back(static_cast<uint8_t>(letter));
  for (uint8_t byte : data) chunk.push_back(byte);
  put_u32(chunk, crc32(std::span<const uint8_t>(chunk).subspan(4)));
  return chunk;
}

Bytes png_header(const PngSpec& spec) {
  Bytes header;
  put_u32(header, static_cast<uint32_t>(spec.width));
  put_u32(header, static_cast<uint32_t>(spec.height));
  for (int byte : {spec.bit_depth, spec.color_type, 0, 0, spec.interlaced ? 1 : 0})
    header.push_back(static_cast<uint8_t>(byte));
  return header;
}

Bytes png_filtered_rows(const PngSpec& spec) {
  struct Pass {
    int x0, y0, dx, dy;
  };
  std::vector<Pass> passes = {{0, 0, 1, 1}};
  if (spec.interlaced)
    passes = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
  Bytes rows;
  int n_rows = 0;
  const auto distance = static_cast<size_t>(std::max(1, channels_of(spec.color_type) * spec.bit_depth / 8));
  for (const Pass& pass : passes) {
    if (pass.x0 >= spec.width) continue;
    Bytes above;
    for (int y = pass.y0; y < spec.height; y += pass.dy) {
      const Bytes row = pack_row(spec, pass.x0, pass.dx, y);
      above.resize(row.size());
      append_filtered(rows, spec.filter >= 0 ? spec.filter : (n_rows++ * 2 + 1) % 5, row, above, distance);
      above = row;
    }
  }
  return rows;
}

Bytes join(std::initializer_list<std::span<const uint8_t>> pieces) {
  Bytes all;
  for (const auto& piece : pieces)
    for (uint8_t byte : piece) all.push_back(byte);
  return all;
}

Bytes png_file(const PngSpec& spec, std::span<const uint8_t> compressed) {
  Bytes file = join({png_signature(), png_chunk("IHDR", png_header(spec))});
  const auto append = [&](std::string_view type, std::span<const uint8_t> data) {
    for (uint8_t byte : png_chunk(type, data)) file.push_back(byte);
  };
  if (!spec.palette.empty()) append("PLTE", spec.palette);
  if (!spec.transparency.empty()) append("tRNS", spec.transparency);
  for (size_t at = 0; at < compressed.size(); at += spec.idat_size)
    append("IDAT", compressed.subspan(at, std::min(spec.idat_size, compressed.size() - at)));
  append("IEND", {});
  return file;
}

Bytes png_file(const PngSpec& spec) {
  return png_file(spec, deflate_zlib(png_filtered_rows(spec)));
}

}  // namespace pac::test
