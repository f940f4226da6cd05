#include "base/pfm.h"

#include <bit>
#include <cstddef>
#include <string>

#include "base/text_scanner.h"

namespace pac {
namespace {

struct PfmHeader {
  int width = 0, height = 0;
  bool is_little_endian = false;
  size_t data_offset = 0;
};

// "[-]digits[.digits]", not zero. Only the sign matters.
bool read_scale_is_negative(TextScanner& text) {
  const char* const what = "PFM scale is not a number other than 0";
  const bool is_negative = text.peek() == '-';
  if (is_negative) text.next();
  bool is_zero = true, has_digit = false;
  for (int c = text.peek(); TextScanner::is_digit(c) || c == '.'; c = text.peek()) {
    has_digit = has_digit || c != '.';
    is_zero = is_zero && (c == '0' || c == '.');
    text.next();
  }
  if (!has_digit || is_zero) text.fail_here(what);
  return is_negative;
}

Result<PfmHeader> read_header(std::span<const uint8_t> bytes) {
  if (bytes.size() < 3) return Failure{Error::truncated, bytes.size(), "PFM header ends early"};
  if (bytes[0] == 'P' && bytes[1] == 'F') return Failure{Error::unsupported, 1, "PFM with three channels"};
  if (bytes[0] != 'P' || bytes[1] != 'f') return Failure{Error::corrupt, 0, "not a PFM signature"};
  TextScanner text(bytes, 2);
  PfmHeader header;
  text.expect_space("PFM signature is not followed by white space");
  text.skip_space(false);
  header.width = static_cast<int>(text.read_number(0x7FFFFFFF, "PFM width is not a number 1..2^31-1"));
  text.skip_space(false);
  header.height = static_cast<int>(text.read_number(0x7FFFFFFF, "PFM height is not a number 1..2^31-1"));
  if (header.width == 0 || header.height == 0) text.fail(Error::corrupt, "PFM size is 0");
  text.skip_space(false);
  header.is_little_endian = read_scale_is_negative(text);
  text.expect_space("PFM header does not end with white space");
  if (!text.ok()) return text.failure();
  header.data_offset = text.offset();
  return header;
}

}  // namespace

Result<DepthImage> decode_pfm(std::span<const uint8_t> bytes, const Limits& limits) {
  PAC_TRY(const PfmHeader header, read_header(bytes));
  const uint64_t n_pixels = static_cast<uint64_t>(header.width) * static_cast<uint64_t>(header.height);
  if (n_pixels > limits.max_pixels) return Failure{Error::limit_exceeded, 3, "image has more pixels than the limit"};
  if (bytes.size() - header.data_offset < 4 * n_pixels)
    return Failure{Error::truncated, bytes.size(), "PFM samples end early"};
  PAC_TRY(auto image, DepthImage::create(header.width, header.height, limits));
  const uint8_t* p = bytes.data() + header.data_offset;
  for (int y = header.height - 1; y >= 0; --y) {
    for (int x = 0; x < header.width; ++x, p += 4) {
      const uint32_t little = uint32_t{p[0]} | uint32_t{p[1]} << 8 | uint32_t{p[2]} << 16 | uint32_t{p[3]} << 24;
      const uint32_t big = uint32_t{p[0]} << 24 | uint32_t{p[1]} << 16 | uint32_t{p[2]} << 8 | uint32_t{p[3]};
      *image.pixel(x, y) = std::bit_cast<float>(header.is_little_endian ? little : big);
    }
  }
  return image;
}

std::vector<uint8_t> encode_pfm(PlaneView<const float> plane) {
  PAC_ASSERT(!plane.empty());
  const std::string header = "Pf\n" + std::to_string(plane.width) + " " + std::to_string(plane.height) + "\n-1.0\n";
  std::vector<uint8_t> out(header.begin(), header.end());
  out.reserve(out.size() + 4 * static_cast<size_t>(plane.width) * static_cast<size_t>(plane.height));
  for (int y = plane.height - 1; y >= 0; --y) {
    for (int x = 0; x < plane.width; ++x) {
      const auto bits = std::bit_cast<uint32_t>(*plane.pixel(x, y));
      for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<uint8_t>(bits >> shift));
    }
  }
  return out;
}

}  // namespace pac
