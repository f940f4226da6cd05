#include "base/y4m.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

#include "base/text_scanner.h"

namespace pac {
namespace {

// Skips `word`, byte by byte.
void expect_word(TextScanner& text, std::string_view word, const char* what) {
  for (char c : word) text.expect(c, what);
}

bool ends_parameter(int c) {
  return c == ' ' || c == '\n' || c == -1;
}

// "n:m", both 0 or both positive.
void read_ratio(TextScanner& text, int& numerator, int& denominator, const char* what) {
  numerator = static_cast<int>(text.read_number(0x7FFFFFFF, what));
  text.expect(':', what);
  denominator = static_cast<int>(text.read_number(0x7FFFFFFF, what));
  if ((numerator == 0) != (denominator == 0)) text.fail(Error::corrupt, what);
}

int read_side(TextScanner& text, const char* what) {
  const auto side = static_cast<int>(text.read_number(0x7FFFFFFF, what));
  if (side == 0) text.fail(Error::corrupt, what);
  return side;
}

void read_chroma(TextScanner& text, std::span<const uint8_t> bytes, Y4mHeader& header) {
  const size_t start = text.offset();
  size_t end = start;
  while (end < bytes.size() && !ends_parameter(bytes[end])) ++end;
  const std::string_view name(reinterpret_cast<const char*>(bytes.data()) + start, end - start);
  if (name == "420" || name == "420jpeg") {
    header.siting = ChromaSiting::jpeg;
  } else if (name == "420mpeg2") {
    header.siting = ChromaSiting::mpeg2;
  } else if (name == "420paldv") {
    header.siting = ChromaSiting::paldv;
  } else {
    return end == bytes.size() ? text.fail(Error::truncated, "Y4M header ends early")
                               : text.fail(Error::unsupported, "Y4M chroma is not 8-bit 4:2:0");
  }
  while (text.ok() && text.offset() < end) text.next();
}

// One parameter, its tag letter already read.
void read_parameter(TextScanner& text, int tag, std::span<const uint8_t> bytes, Y4mHeader& header) {
  switch (tag) {
    case 'W':
      header.width = read_side(text, "Y4M width is not a number 1..2^31-1");
      break;
    case 'H':
      header.height = read_side(text, "Y4M height is not a number 1..2^31-1");
      break;
    case 'F':
      read_ratio(text, header.rate_numerator, header.rate_denominator, "Y4M frame rate is not a ratio");
      break;
    case 'A':
      read_ratio(text, header.aspect_numerator, header.aspect_denominator, "Y4M aspect is not a ratio");
      break;
    case 'C':
      read_chroma(text, bytes, header);
      break;
    case 'I':
      if (text.peek() == 't' || text.peek() == 'b' || text.peek() == 'm')
        return text.fail(Error::unsupported, "Y4M is interlaced");
      if (text.peek() != 'p' && text.peek() != '?') return text.fail_here("Y4M interlacing is undefined");
      text.next();
      break;
    case 'X':  // a comment
      while (!ends_parameter(text.peek())) text.next();
      break;
    default:
      return text.fail(Error::corrupt, "Y4M parameter is undefined");
  }
  if (!ends_parameter(text.peek())) text.fail_here("Y4M parameter has trailing characters");
}

uint64_t frame_bytes(const Y4mHeader& header) {
  const auto w = static_cast<uint64_t>(header.width), h = static_cast<uint64_t>(header.height);
  return w * h + 2 * ((w + 1) / 2) * ((h + 1) / 2);
}

void copy_plane(GrayImage& to, const uint8_t*& from) {
  for (int y = 0; y < to.height(); ++y, from += to.width())
    std::memcpy(to.row(y), from, static_cast<size_t>(to.width()));
}

void append(std::vector<uint8_t>& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
}

}  // namespace

Result<Y4mReader> Y4mReader::open(std::span<const uint8_t> bytes, const Limits& limits) {
  TextScanner text(bytes);
  Y4mReader reader;
  reader.bytes_ = bytes;
  expect_word(text, "YUV4MPEG2", "not a Y4M signature");
  uint32_t seen = 0;  // bit i: parameter 'A' + i
  while (text.ok() && text.peek() == ' ') {
    text.next();
    const int tag = text.peek();
    if (tag < 'A' || tag > 'Z') {
      text.fail_here("Y4M parameter is undefined");
      break;
    }
    const uint32_t bit = 1u << (tag - 'A');
    if ((seen & bit) != 0 && tag != 'X') text.fail(Error::corrupt, "Y4M parameter is repeated");
    seen |= bit;
    text.next();
    if (text.ok()) read_parameter(text, tag, bytes, reader.header_);
  }
  text.expect('\n', "Y4M header does not end with a line break");
  if (!text.ok()) return text.failure();
  reader.at_ = text.offset();
  if (reader.header_.width == 0) return Failure{Error::corrupt, reader.at_, "Y4M header without a width"};
  if (reader.header_.height == 0) return Failure{Error::corrupt, reader.at_, "Y4M header without a height"};
  const uint64_t n_pixels = static_cast<uint64_t>(reader.header_.width) * static_cast<uint64_t>(reader.header_.height);
  if (n_pixels > limits.max_pixels || !GrayImage::create(reader.header_.width, 0, limits).ok() ||
      !GrayImage::create(0, reader.header_.height, limits).ok())
    return Failure{Error::limit_exceeded, 0, "image has more pixels than the limit"};
  return reader;
}

Result<bool> Y4mReader::next(Frame420& frame) {
  if (at_ == bytes_.size()) return false;
  TextScanner text(bytes_, at_);
  expect_word(text, "FRAME", "not a Y4M frame header");
  if (text.ok() && !ends_parameter(text.peek())) text.fail_here("not a Y4M frame header");
  while (text.ok() && text.peek() != '\n' && !text.at_end()) text.next();  // parameters of one frame: none matters
  text.expect('\n', "Y4M frame header does not end with a line break");
  if (!text.ok()) return text.failure();
  const uint64_t n = frame_bytes(header_);
  if (bytes_.size() - text.offset() < n) return Failure{Error::truncated, bytes_.size(), "Y4M frame ends early"};
  if (frame.width() != header_.width || frame.height() != header_.height)
    frame = Frame420(header_.width, header_.height);
  const uint8_t* from = bytes_.data() + text.offset();
  copy_plane(frame.y, from);
  copy_plane(frame.cb, from);
  copy_plane(frame.cr, from);
  at_ = text.offset() + static_cast<size_t>(n);
  return true;
}

void append_y4m_header(std::vector<uint8_t>& out, const Y4mHeader& header) {
  PAC_ASSERT(header.width >= 1 && header.height >= 1);
  constexpr const char* kSitings[] = {"420jpeg", "420mpeg2", "420paldv"};
  const auto ratio = [](int n, int m) { return std::to_string(n) + ":" + std::to_string(m); };
  append(out, "YUV4MPEG2 W" + std::to_string(header.width) + " H" + std::to_string(header.height));
  append(out, " F" + ratio(header.rate_numerator, header.rate_denominator) + " Ip");
  append(out, " A" + ratio(header.aspect_numerator, header.aspect_denominator));
  append(out, std::string(" C") + kSitings[static_cast<size_t>(header.siting)] + "\n");
}

void append_y4m_frame(std::vector<uint8_t>& out, const Frame420& frame) {
  append(out, "FRAME\n");
  for (const GrayImage* plane : {&frame.y, &frame.cb, &frame.cr})
    for (int y = 0; y < plane->height(); ++y) out.insert(out.end(), plane->row(y), plane->row(y) + plane->width());
}

}  // namespace pac
