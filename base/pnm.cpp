#include "base/pnm.h"

#include <cstddef>
#include <cstring>
#include <string>

#include "base/text_scanner.h"

namespace pac {
namespace {

using Bytes = std::span<const uint8_t>;

uint8_t to_8_bits(uint32_t sample, uint32_t maxval) {
  return static_cast<uint8_t>((sample * 255u + maxval / 2) / maxval);
}

// The samples in file order, one at a time, each checked against maxval.
class SampleReader {
 public:
  SampleReader(Bytes bytes, const PnmHeader& header)
      : bytes_(bytes),
        header_(header),
        maxval_(static_cast<uint32_t>(header.maxval)),
        text_(bytes, header.data_offset) {}

  // A whole row of raw 8-bit samples that need no scaling, or null.
  const uint8_t* plain_copy_of_row(size_t n_samples) {
    if (header_.is_plain || maxval_ != 255) return nullptr;
    const uint8_t* row = bytes_.data() + at_ + header_.data_offset;
    at_ += n_samples;
    return row;
  }
  uint8_t next() {
    const uint32_t sample = header_.is_plain ? next_plain() : next_raw();
    return ok() ? to_8_bits(sample, maxval_) : uint8_t{0};
  }
  bool ok() const { return text_.ok(); }
  const Failure& failure() const { return text_.failure(); }

 private:
  uint32_t next_plain() {
    text_.skip_space(true);
    const uint32_t sample = text_.read_number(maxval_, "PNM sample is not a number up to maxval");
    if (text_.ok() && !text_.at_end() && !TextScanner::is_space(text_.peek()) && text_.peek() != '#')
      text_.fail_here("PNM sample is followed by something else than white space");
    return sample;
  }
  uint32_t next_raw() {
    const size_t offset = header_.data_offset + at_;
    uint32_t sample = bytes_[offset];
    if (maxval_ > 255) sample = sample << 8 | bytes_[offset + 1];
    at_ += maxval_ > 255 ? 2 : 1;
    if (sample > maxval_ && text_.ok()) {
      text_ = TextScanner(bytes_, offset);
      text_.fail(Error::corrupt, "PNM sample is over maxval");
    }
    return sample;
  }

  Bytes bytes_;
  const PnmHeader& header_;
  uint32_t maxval_;
  TextScanner text_;  // cursor of plain files; holds the failure of both kinds
  size_t at_ = 0;     // bytes of raw samples taken
};

// What the samples occupy at least: raw files exactly; plain ones a digit and a separator each.
Result<void> check_sizes(Bytes bytes, const PnmHeader& header, const Limits& limits) {
  const uint64_t n_pixels = static_cast<uint64_t>(header.width) * static_cast<uint64_t>(header.height);
  if (n_pixels > limits.max_pixels) return Failure{Error::limit_exceeded, 2, "image has more pixels than the limit"};
  const uint64_t n_samples = n_pixels * (header.is_rgb ? 3 : 1);
  const uint64_t n_bytes = header.is_plain ? 2 * n_samples - 1 : header.maxval > 255 ? 2 * n_samples : n_samples;
  if (bytes.size() - header.data_offset < n_bytes)
    return Failure{Error::truncated, bytes.size(), "PNM samples end early"};
  return {};
}

template <int kChannels>
Result<Image<uint8_t, kChannels>> decode(Bytes bytes, const PnmHeader& header, const Limits& limits) {
  PAC_CHECK(check_sizes(bytes, header, limits));
  PAC_TRY(auto image, (Image<uint8_t, kChannels>::create(header.width, header.height, limits)));
  const bool spread = kChannels == 3 && !header.is_rgb;
  const size_t n_samples = static_cast<size_t>(header.width) * (header.is_rgb ? 3 : 1);
  SampleReader samples(bytes, header);
  for (int y = 0; y < header.height; ++y) {
    uint8_t* row = image.row(y);
    if (const uint8_t* raw = spread ? nullptr : samples.plain_copy_of_row(n_samples)) {
      std::memcpy(row, raw, n_samples);
      continue;
    }
    for (size_t i = 0; i < n_samples; ++i) {
      const uint8_t sample = samples.next();
      if (spread) {
        std::memset(row + 3 * i, sample, 3);
      } else {
        row[i] = sample;
      }
    }
    if (!samples.ok()) return samples.failure();
  }
  return image;
}

template <int kChannels>
std::vector<uint8_t> encode(ImageView<const uint8_t, kChannels> image) {
  PAC_ASSERT(!image.empty());
  const std::string header =
      (kChannels == 3 ? "P6\n" : "P5\n") + std::to_string(image.width) + " " + std::to_string(image.height) + "\n255\n";
  const size_t row_bytes = static_cast<size_t>(image.width) * kChannels;
  std::vector<uint8_t> out(header.begin(), header.end());
  out.reserve(out.size() + row_bytes * static_cast<size_t>(image.height));
  for (int y = 0; y < image.height; ++y) out.insert(out.end(), image.row(y), image.row(y) + row_bytes);
  return out;
}

}  // namespace

bool is_pnm(Bytes bytes) {
  if (bytes.size() < 3 || bytes[0] != 'P') return false;
  const bool is_kind = bytes[1] == '2' || bytes[1] == '3' || bytes[1] == '5' || bytes[1] == '6';
  return is_kind && (TextScanner::is_space(bytes[2]) || bytes[2] == '#');
}

Result<PnmHeader> read_pnm_header(Bytes bytes) {
  if (bytes.size() < 3) return Failure{Error::truncated, bytes.size(), "PNM header ends early"};
  if (bytes[0] == 'P' && (bytes[1] == '1' || bytes[1] == '4'))
    return Failure{Error::unsupported, 1, "PBM bitmaps are not supported"};
  if (!is_pnm(bytes)) return Failure{Error::corrupt, 0, "not a PNM signature"};
  PnmHeader header;
  header.is_rgb = bytes[1] == '3' || bytes[1] == '6';
  header.is_plain = bytes[1] == '2' || bytes[1] == '3';
  TextScanner text(bytes, 2);
  const auto number = [&](uint32_t max, const char* what) {
    text.skip_space(true);
    const size_t offset = text.offset();
    const uint32_t value = text.read_number(max, what);
    if (text.ok() && value == 0) {
      text = TextScanner(bytes, offset);
      text.fail(Error::corrupt, what);
    }
    return static_cast<int>(value);
  };
  header.width = number(0x7FFFFFFF, "PNM width is not a number 1..2^31-1");
  header.height = number(0x7FFFFFFF, "PNM height is not a number 1..2^31-1");
  header.maxval = number(65535, "PNM maxval is not a number 1..65535");
  if (text.ok() && text.peek() == '#')
    text.skip_space(true);  // skips the line break with the comment
  else
    text.expect_space("PNM header does not end with white space");
  if (!text.ok()) return text.failure();
  header.data_offset = text.offset();
  return header;
}

Result<RgbImage> decode_pnm_rgb(Bytes bytes, const Limits& limits) {
  PAC_TRY(const PnmHeader header, read_pnm_header(bytes));
  return decode<3>(bytes, header, limits);
}

Result<GrayImage> decode_pgm(Bytes bytes, const Limits& limits) {
  PAC_TRY(const PnmHeader header, read_pnm_header(bytes));
  if (header.is_rgb) return Failure{Error::unsupported, 1, "PNM is not a gray image"};
  return decode<1>(bytes, header, limits);
}

std::vector<uint8_t> encode_ppm(ConstRgbView image) {
  return encode(image);
}
std::vector<uint8_t> encode_pgm(PlaneView<const uint8_t> image) {
  return encode(image);
}

}  // namespace pac
