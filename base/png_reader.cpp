// PNG decoder: chunks -> zlib stream -> filtered rows -> samples -> pixels.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "base/checksum.h"
#include "base/inflate.h"
#include "base/png.h"
#include "base/png_filter.h"

namespace pac {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr uint8_t kSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

uint32_t read_u32(const uint8_t* p) {
  return uint32_t{p[0]} << 24 | uint32_t{p[1]} << 16 | uint32_t{p[2]} << 8 | p[3];
}

constexpr uint32_t chunk_type(const char (&name)[5]) {
  uint32_t type = 0;
  for (int i = 0; i < 4; ++i) type = type << 8 | static_cast<uint8_t>(name[i]);
  return type;
}
constexpr uint32_t kIhdr = chunk_type("IHDR"), kPlte = chunk_type("PLTE"), kTrns = chunk_type("tRNS"),
                   kIdat = chunk_type("IDAT"), kIend = chunk_type("IEND");

struct Chunk {
  uint32_t type = 0;
  size_t offset = 0;  // of the length field, in the file
  Bytes data;
  size_t data_offset() const { return offset + 8; }
};

// The chunk at `offset`, its CRC verified [PNG 5.3].
Result<Chunk> read_chunk(Bytes file, size_t offset) {
  if (file.size() - offset < 12) return Failure{Error::truncated, file.size(), "PNG ends before IEND"};
  const uint32_t length = read_u32(&file[offset]);
  if (length > 0x7FFFFFFF) return Failure{Error::corrupt, offset, "PNG chunk length is over 2^31 - 1"};
  for (size_t i = 4; i < 8; ++i) {
    const int letter = file[offset + i] | 0x20;
    if (letter < 'a' || letter > 'z') return Failure{Error::corrupt, offset + i, "PNG chunk type is not four letters"};
  }
  if (length > file.size() - offset - 12) return Failure{Error::truncated, file.size(), "PNG chunk ends early"};
  const Chunk chunk{read_u32(&file[offset + 4]), offset, file.subspan(offset + 8, length)};
  if (crc32(file.subspan(offset + 4, length + 4)) != read_u32(&file[offset + 8 + length]))
    return Failure{Error::corrupt, offset + 8 + length, "PNG chunk CRC is wrong"};
  return chunk;
}

bool is_legal_depth(int color_type, int bit_depth) {  // [PNG 11.2.2, table 11.1]
  switch (color_type) {
    case PngHeader::gray:
      return bit_depth == 1 || bit_depth == 2 || bit_depth == 4 || bit_depth == 8 || bit_depth == 16;
    case PngHeader::palette:
      return bit_depth == 1 || bit_depth == 2 || bit_depth == 4 || bit_depth == 8;
    default:
      return bit_depth == 8 || bit_depth == 16;
  }
}

Result<PngHeader> parse_header(const Chunk& chunk) {
  const Bytes d = chunk.data;
  const size_t at = chunk.data_offset();
  if (chunk.type != kIhdr) return Failure{Error::corrupt, chunk.offset, "PNG does not begin with IHDR"};
  if (d.size() != 13) return Failure{Error::corrupt, chunk.offset, "PNG header is not 13 bytes long"};
  const uint32_t width = read_u32(&d[0]), height = read_u32(&d[4]);
  if (width == 0 || width > 0x7FFFFFFF) return Failure{Error::corrupt, at, "PNG width is 0 or over 2^31 - 1"};
  if (height == 0 || height > 0x7FFFFFFF) return Failure{Error::corrupt, at + 4, "PNG height is 0 or over 2^31 - 1"};
  if (d[9] > 6 || d[9] == 1 || d[9] == 5) return Failure{Error::corrupt, at + 9, "PNG color type is undefined"};
  if (!is_legal_depth(d[9], d[8]))
    return Failure{Error::corrupt, at + 8, "PNG bit depth is illegal for its color type"};
  if (d[10] != 0) return Failure{Error::corrupt, at + 10, "PNG compression method is undefined"};
  if (d[11] != 0) return Failure{Error::corrupt, at + 11, "PNG filter method is undefined"};
  if (d[12] > 1) return Failure{Error::corrupt, at + 12, "PNG interlace method is undefined"};
  return PngHeader{static_cast<int>(width), static_cast<int>(height), d[8], static_cast<PngHeader::ColorType>(d[9]),
                   d[12] == 1};
}

int samples_per_pixel(PngHeader::ColorType type) {
  switch (type) {
    case PngHeader::rgb:
      return 3;
    case PngHeader::gray_alpha:
      return 2;
    case PngHeader::rgba:
      return 4;
    default:
      return 1;
  }
}

// One of the seven reduced images, or the whole one [PNG 8.2].
struct Pass {
  int x0, y0, dx, dy;
};
constexpr Pass kWhole[1] = {{0, 0, 1, 1}};
constexpr Pass kAdam7[7] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                            {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};

std::span<const Pass> passes_of(const PngHeader& header) {
  return header.interlaced ? std::span<const Pass>(kAdam7) : std::span<const Pass>(kWhole);
}
int pass_size(int size, int first, int step) {
  return size <= first ? 0 : static_cast<int>((int64_t{size} - first + step - 1) / step);
}
uint64_t row_bytes(const PngHeader& header, int width) {
  const auto bits = static_cast<uint64_t>(samples_per_pixel(header.color_type) * header.bit_depth);
  return (static_cast<uint64_t>(width) * bits + 7) / 8;
}

// Bytes of all filtered rows: what the zlib stream must hold, exactly.
uint64_t filtered_size(const PngHeader& header) {
  uint64_t size = 0;
  for (const Pass& pass : passes_of(header)) {
    const int width = pass_size(header.width, pass.x0, pass.dx), height = pass_size(header.height, pass.y0, pass.dy);
    if (width > 0) size += static_cast<uint64_t>(height) * (1 + row_bytes(header, width));
  }
  return size;
}

struct Rgba {
  uint8_t r = 0, g = 0, b = 0, a = 255;
};

// Everything the file says, before decompression.
struct PngFile {
  PngHeader header;
  std::array<Rgba, 256> palette{};
  int n_palette = 0;
  bool has_key = false;             // tRNS of gray and RGB files: this one color is transparent
  std::array<uint16_t, 3> key{};    // in samples of bit_depth bits
  std::vector<uint8_t> compressed;  // the IDAT chunks joined
  struct Piece {
    size_t stream_offset, file_offset;
  };
  std::vector<Piece> pieces;  // where in the file each IDAT's data lies

  // A failure inside the zlib stream, told by its place in the file.
  Failure in_file(Failure failure) const {
    const Piece* found = nullptr;
    for (const Piece& piece : pieces)
      if (piece.stream_offset <= failure.byte_offset) found = &piece;
    if (found != nullptr) failure.byte_offset = found->file_offset + failure.byte_offset - found->stream_offset;
    return failure;
  }
};

Result<void> parse_palette(const Chunk& chunk, PngFile& png) {
  const auto type = png.header.color_type;
  if (png.n_palette != 0) return Failure{Error::corrupt, chunk.offset, "second PLTE chunk"};
  if (!png.pieces.empty() || png.has_key) return Failure{Error::corrupt, chunk.offset, "PLTE chunk is out of order"};
  if (type == PngHeader::gray || type == PngHeader::gray_alpha)
    return Failure{Error::corrupt, chunk.offset, "PLTE chunk in a gray image"};
  const size_t n = chunk.data.size() / 3;
  const size_t max = type == PngHeader::palette ? size_t{1} << png.header.bit_depth : 256;
  if (chunk.data.size() % 3 != 0 || n == 0 || n > max)
    return Failure{Error::corrupt, chunk.offset, "PLTE chunk has an illegal length"};
  for (size_t i = 0; i < n; ++i)
    png.palette[i] = {chunk.data[3 * i], chunk.data[3 * i + 1], chunk.data[3 * i + 2], 255};
  png.n_palette = static_cast<int>(n);
  return {};
}

Result<void> parse_transparency(const Chunk& chunk, PngFile& png, bool seen_before) {
  const Failure bad_length{Error::corrupt, chunk.offset, "tRNS chunk has an illegal length"};
  if (seen_before) return Failure{Error::corrupt, chunk.offset, "second tRNS chunk"};
  if (!png.pieces.empty()) return Failure{Error::corrupt, chunk.offset, "tRNS chunk is out of order"};
  const Bytes d = chunk.data;
  switch (png.header.color_type) {
    case PngHeader::palette:
      if (png.n_palette == 0) return Failure{Error::corrupt, chunk.offset, "tRNS chunk is out of order"};
      if (d.size() > static_cast<size_t>(png.n_palette)) return bad_length;
      for (size_t i = 0; i < d.size(); ++i) png.palette[i].a = d[i];
      return {};
    case PngHeader::gray:
    case PngHeader::rgb: {
      const auto n = static_cast<size_t>(samples_per_pixel(png.header.color_type));
      if (d.size() != 2 * n) return bad_length;
      for (size_t i = 0; i < n; ++i) png.key[i] = static_cast<uint16_t>(d[2 * i] << 8 | d[2 * i + 1]);
      png.has_key = true;
      return {};
    }
    default:
      return Failure{Error::corrupt, chunk.offset, "tRNS chunk in an image with alpha"};
  }
}

// All chunks up to IEND [PNG 5.6: order].
Result<PngFile> parse_chunks(Bytes file) {
  PngFile png;
  PAC_TRY(png.header, read_png_header(file));
  bool seen_trns = false, idat_ended = false;
  size_t offset = sizeof kSignature + 12 + 13;
  while (true) {
    PAC_TRY(const Chunk chunk, read_chunk(file, offset));
    offset = chunk.data_offset() + chunk.data.size() + 4;
    if (chunk.type != kIdat && !png.pieces.empty()) idat_ended = true;
    if (chunk.type == kIend) {
      if (!chunk.data.empty()) return Failure{Error::corrupt, chunk.offset, "IEND chunk is not empty"};
      if (png.pieces.empty()) return Failure{Error::corrupt, chunk.offset, "PNG has no IDAT chunk"};
      return png;
    }
    if (chunk.type == kIdat) {
      if (idat_ended) return Failure{Error::corrupt, chunk.offset, "IDAT chunks are not consecutive"};
      if (png.header.color_type == PngHeader::palette && png.n_palette == 0)
        return Failure{Error::corrupt, chunk.offset, "palette image without PLTE"};
      png.pieces.push_back({png.compressed.size(), chunk.data_offset()});
      png.compressed.insert(png.compressed.end(), chunk.data.begin(), chunk.data.end());
    } else if (chunk.type == kPlte) {
      PAC_CHECK(parse_palette(chunk, png));
    } else if (chunk.type == kTrns) {
      PAC_CHECK(parse_transparency(chunk, png, seen_trns));
      seen_trns = true;
    } else if (chunk.type == kIhdr) {
      return Failure{Error::corrupt, chunk.offset, "second IHDR chunk"};
    } else if ((file[chunk.offset + 4] & 0x20) == 0) {  // bit 5 of the first letter: ancillary [PNG 5.4]
      return Failure{Error::unsupported, chunk.offset, "unknown critical PNG chunk"};
    }
  }
}

// The filtered rows, after every size check.
Result<std::vector<uint8_t>> decompress(const PngFile& png, const Limits& limits) {
  const uint64_t size = filtered_size(png.header);
  if (size > limits.max_bytes) return Failure{Error::limit_exceeded, 16, "PNG holds more bytes than the limit"};
  // Deflate's best is 258 bytes for 2 bits. Without this check a file of 100 bytes could claim the whole limit.
  if (size / 1032 > png.compressed.size())
    return png.in_file({Error::truncated, png.compressed.size(), "PNG image data ends early"});
  std::vector<uint8_t> rows(size);
  auto sizes = inflate_zlib(png.compressed, rows);
  if (!sizes.ok()) {
    Failure failure = png.in_file(sizes.failure());
    if (failure.error == Error::out_of_space)
      failure = {Error::corrupt, failure.byte_offset, "PNG image data holds more than the header says"};
    return failure;
  }
  if (sizes->n_written != size)
    return png.in_file({Error::corrupt, sizes->n_read, "PNG image data holds less than the header says"});
  if (sizes->n_read != png.compressed.size())
    return png.in_file({Error::corrupt, sizes->n_read, "PNG image data goes on after its end"});
  return rows;
}

// Rows of packed samples to 8-bit RGBA pixels.
class Unpacker {
 public:
  explicit Unpacker(const PngFile& png) : png_(png), depth_(png.header.bit_depth) {}

  // False if a palette index is past the palette.
  bool unpack(const uint8_t* row, int width, Rgba* out) const {
    const int n = samples_per_pixel(png_.header.color_type);
    for (int x = 0; x < width; ++x) {
      std::array<uint16_t, 4> s{};
      for (int i = 0; i < n; ++i) s[static_cast<size_t>(i)] = sample(row, int64_t{x} * n + i);
      if (!pixel(s, out[x])) return false;
    }
    return true;
  }

 private:
  uint16_t sample(const uint8_t* row, int64_t index) const {
    if (depth_ == 8) return row[index];
    if (depth_ == 16) return static_cast<uint16_t>(row[2 * index] << 8 | row[2 * index + 1]);
    const int64_t bit = index * depth_;
    return static_cast<uint16_t>(row[bit >> 3] >> (8 - depth_ - (bit & 7)) & ((1 << depth_) - 1));
  }
  // v * 255 / (2^depth - 1), rounded to nearest; exact for depths that divide 8.
  uint8_t to_8_bits(uint32_t v) const {
    const uint32_t max = (1u << depth_) - 1;
    return static_cast<uint8_t>((v * 255u + max / 2) / max);
  }
  bool pixel(const std::array<uint16_t, 4>& s, Rgba& out) const {
    const auto key_alpha = [&](bool matches) { return static_cast<uint8_t>(png_.has_key && matches ? 0 : 255); };
    switch (png_.header.color_type) {
      case PngHeader::palette:
        if (s[0] >= png_.n_palette) return false;
        out = png_.palette[s[0]];
        return true;
      case PngHeader::gray:
      case PngHeader::gray_alpha: {
        const uint8_t v = to_8_bits(s[0]);
        const bool has_alpha = png_.header.color_type == PngHeader::gray_alpha;
        out = {v, v, v, has_alpha ? to_8_bits(s[1]) : key_alpha(s[0] == png_.key[0])};
        return true;
      }
      case PngHeader::rgb:
        out = {to_8_bits(s[0]), to_8_bits(s[1]), to_8_bits(s[2]),
               key_alpha(s[0] == png_.key[0] && s[1] == png_.key[1] && s[2] == png_.key[2])};
        return true;
      case PngHeader::rgba:
        out = {to_8_bits(s[0]), to_8_bits(s[1]), to_8_bits(s[2]), to_8_bits(s[3])};
        return true;
    }
    return false;
  }

  const PngFile& png_;
  int depth_;
};

template <int kChannels>
void store(const Rgba& from, uint8_t* to) {
  to[0] = from.r;
  if constexpr (kChannels >= 3) {
    to[1] = from.g;
    to[2] = from.b;
  }
  if constexpr (kChannels == 4) to[3] = from.a;
}

// Undoes the filters of one pass in place and scatters its pixels. `rows` begins at the pass; returns its bytes.
template <int kChannels>
Result<size_t> decode_pass(const PngFile& png, const Pass& pass, std::span<uint8_t> rows,
                           ImageView<uint8_t, kChannels> image) {
  const PngHeader& header = png.header;
  const int width = pass_size(header.width, pass.x0, pass.dx), height = pass_size(header.height, pass.y0, pass.dy);
  if (width == 0 || height == 0) return size_t{0};
  const auto n = static_cast<size_t>(row_bytes(header, width));
  const auto bpp = static_cast<size_t>(std::max(1, samples_per_pixel(header.color_type) * header.bit_depth / 8));
  const bool is_plain = header.color_type == PngHeader::rgb && header.bit_depth == 8 && kChannels == 3 && pass.dx == 1;
  const Failure failure{Error::corrupt, png.pieces.front().file_offset, ""};
  const std::vector<uint8_t> zeros(n, 0);
  std::vector<Rgba> pixels(static_cast<size_t>(width));
  const Unpacker unpacker(png);
  const uint8_t* above = zeros.data();
  for (int y = 0; y < height; ++y) {
    uint8_t* row = rows.data() + static_cast<size_t>(y) * (n + 1);
    if (row[0] >= kPngFilterCount)
      return Failure{failure.error, failure.byte_offset, "PNG row has an undefined filter"};
    unfilter_png_row(static_cast<PngFilter>(row[0]), row + 1, above, n, bpp);
    above = row + 1;
    uint8_t* to = image.pixel(pass.x0, pass.y0 + y * pass.dy);
    if (is_plain) {
      std::memcpy(to, row + 1, n);
      continue;
    }
    if (!unpacker.unpack(row + 1, width, pixels.data()))
      return Failure{failure.error, failure.byte_offset, "PNG palette index is past the palette"};
    for (int x = 0; x < width; ++x)
      store<kChannels>(pixels[static_cast<size_t>(x)], to + ptrdiff_t{x} * pass.dx * kChannels);
  }
  return (n + 1) * static_cast<size_t>(height);
}

template <int kChannels>
Result<Image<uint8_t, kChannels>> decode(Bytes file, const Limits& limits) {
  PAC_TRY(const PngHeader header, read_png_header(file));
  if (kChannels == 1 && header.color_type != PngHeader::gray && header.color_type != PngHeader::gray_alpha)
    return Failure{Error::unsupported, 25, "PNG is not a gray image"};
  if (static_cast<uint64_t>(header.width) * static_cast<uint64_t>(header.height) > limits.max_pixels)
    return Failure{Error::limit_exceeded, 16, "image has more pixels than the limit"};
  PAC_TRY(const PngFile png, parse_chunks(file));
  PAC_TRY(std::vector<uint8_t> rows, decompress(png, limits));
  auto image = Image<uint8_t, kChannels>::create(header.width, header.height, limits);
  if (!image.ok()) return Failure{image.failure().error, 16, image.failure().text};
  size_t at = 0;
  for (const Pass& pass : passes_of(header)) {
    PAC_TRY(const size_t n, decode_pass<kChannels>(png, pass, std::span(rows).subspan(at), image->view()));
    at += n;
  }
  return image;
}

}  // namespace

bool is_png(Bytes bytes) {
  return bytes.size() >= sizeof kSignature && std::memcmp(bytes.data(), kSignature, sizeof kSignature) == 0;
}

Result<PngHeader> read_png_header(Bytes bytes) {
  for (size_t i = 0; i < sizeof kSignature; ++i) {
    if (i == bytes.size()) return Failure{Error::truncated, i, "PNG signature ends early"};
    if (bytes[i] != kSignature[i]) return Failure{Error::corrupt, i, "not a PNG signature"};
  }
  PAC_TRY(const Chunk chunk, read_chunk(bytes, sizeof kSignature));
  return parse_header(chunk);
}

Result<RgbImage> decode_png_rgb(Bytes bytes, const Limits& limits) {
  return decode<3>(bytes, limits);
}
Result<RgbaImage> decode_png_rgba(Bytes bytes, const Limits& limits) {
  return decode<4>(bytes, limits);
}
Result<GrayImage> decode_png_gray(Bytes bytes, const Limits& limits) {
  return decode<1>(bytes, limits);
}

}  // namespace pac
