// PNG files of every color type, depth, filter and interlacing, built from a rule for the samples; and broken ones.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace pac::test {

using Bytes = std::vector<uint8_t>;

struct PngSpec {
  int width = 1, height = 1;
  int bit_depth = 8, color_type = 2;
  bool interlaced = false;
  int filter = -1;              // 0..4; -1: another one each row
  Bytes palette, transparency;  // contents of PLTE and tRNS; none if empty
  size_t idat_size = 1000;      // bytes a chunk
  // Sample c of pixel (x, y), 0 .. 2^bit_depth - 1; null: hashed from the three.
  std::function<int(int x, int y, int c)> sample;
};

int channels_of(int color_type);
// The sample that the rule gives.
int sample_of(const PngSpec& spec, int x, int y, int c);

// Pieces of a file.
Bytes png_signature();
Bytes png_chunk(std::string_view type, std::span<const uint8_t> data);
Bytes png_header(const PngSpec& spec);         // IHDR's 13 bytes
Bytes png_filtered_rows(const PngSpec& spec);  // what the zlib stream holds
Bytes join(std::initializer_list<std::span<const uint8_t>> pieces);

// Signature, IHDR, PLTE, tRNS, IDAT of `compressed` cut in pieces, IEND.
Bytes png_file(const PngSpec& spec, std::span<const uint8_t> compressed);
Bytes png_file(const PngSpec& spec);

}  // namespace pac::test
