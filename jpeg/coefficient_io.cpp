#include "jpeg/coefficient_io.h"

#include <algorithm>
#include <cstdlib>

#include "base/kernels/block_kernels.h"
#include "jpeg/marker_writer.h"
#include "jpeg/markers.h"
#include "jpeg/metadata_writer.h"
#include "jpeg/scan_decoder.h"
#include "jpeg/scan_writer.h"

namespace pac::jpeg {
namespace {

Failure bad(const char* text) {
  return {Error::bad_argument, 0, text};
}

int blocks_in_mcu(const Frame& frame) {
  int n = 0;
  for (int i = 0; i < frame.n_components; ++i) n += frame.components[i].h * frame.components[i].v;
  return n;
}

// Equal tables share a destination.
int assign_quant_table(const CoefficientImage& image, size_t i, const Frame& frame, int& n_tables) {
  for (size_t j = 0; j < i; ++j)
    if (image.components[j].steps == image.components[i].steps) return frame.components[j].quant_table;
  return n_tables++;
}

Result<Frame> frame_of(const CoefficientImage& image) {
  const size_t n = image.components.size();
  if (image.width < 1 || image.height < 1 || image.width > 65535 || image.height > 65535)
    return bad("JPEG image sides are 1..65535");
  if (n != 1 && n != 3 && n != 4) return bad("components are neither 1, 3 nor 4");
  Frame frame;
  frame.width = image.width;
  frame.height = image.height;
  frame.n_components = static_cast<int>(n);
  int n_tables = 0;
  for (size_t i = 0; i < n; ++i) {
    const CoefficientPlane& plane = image.components[i];
    if (plane.h < 1 || plane.h > 4 || plane.v < 1 || plane.v > 4) return bad("sampling factor is not within 1..4");
    for (const uint16_t step : plane.steps)
      if (step == 0) return bad("quantizer step is 0");
    for (size_t j = 0; j < i; ++j)
      if (image.components[j].id == plane.id) return bad("component id used twice");
    Component& c = frame.components[i];
    c.id = plane.id;
    c.h = plane.h;
    c.v = plane.v;
    c.quant_table = static_cast<uint8_t>(assign_quant_table(image, i, frame, n_tables));
  }
  finish_frame(frame);
  for (size_t i = 0; i < n; ++i) {
    const CoefficientPlane& plane = image.components[i];
    const Component& c = frame.components[i];
    const size_t size =
        size_t{64} * static_cast<size_t>(c.padded_width_blocks) * static_cast<size_t>(c.padded_height_blocks);
    if (plane.width_blocks != c.padded_width_blocks || plane.height_blocks != c.padded_height_blocks ||
        plane.levels.size() != size)
      return bad("blocks of a component are not as many as its size says");
  }
  return frame;
}

// The tokens of all scans in order, and how often each symbol occurs.
class ScanTokens {
 public:
  ScanTokens(const CoefficientImage& image, const Frame& frame, int restart_interval)
      : image_(image), frame_(frame), restart_interval_(restart_interval) {}

  // Components [first, first + n). False: a level is out of range.
  bool add_scan(int first, int n) {
    const bool is_interleaved = n > 1;
    const Component& lone = frame_.components[first];
    const int columns = is_interleaved ? frame_.mcus_per_row : lone.width_blocks;
    const int rows = is_interleaved ? frame_.mcu_rows : lone.height_blocks;
    int to_restart = restart_interval_;
    uint32_t restarts = 0;
    std::fill(std::begin(dc_), std::end(dc_), 0);
    for (int row = 0; row < rows; ++row) {
      reserve(columns);
      for (int column = 0; column < columns; ++column) {
        if (restart_interval_ > 0 && to_restart-- == 0) {
          *out_++ = kRestartToken | (restarts++ & 7);
          to_restart = restart_interval_ - 1;
          std::fill(std::begin(dc_), std::end(dc_), 0);
        }
        for (int c = first; c < first + n; ++c)
          if (!add_mcu(c, column, row, is_interleaved)) return false;
      }
      tokens_.set_end(out_);
    }
    return true;
  }

  size_t size() const { return static_cast<size_t>(tokens_.end() - tokens_.begin()); }
  const Token* begin() const { return tokens_.begin(); }
  const Histogram& histogram() const { return histogram_; }

 private:
  void reserve(int n_mcus) {
    constexpr size_t kMostInMcu = kMaxBlocksInMcu * kMaxTokensInBlock + 1;
    out_ = tokens_.reserve(static_cast<size_t>(n_mcus) * kMostInMcu);
  }

  bool add_mcu(int c, int column, int row, bool is_interleaved) {
    const Component& component = frame_.components[c];
    const int h = is_interleaved ? component.h : 1, v = is_interleaved ? component.v : 1;
    for (int y = row * v; y < (row + 1) * v; ++y)
      for (int x = column * h; x < (column + 1) * h; ++x)
        if (!add_block(c, image_.components[static_cast<size_t>(c)].block(x, y))) return false;
    return true;
  }

  bool add_block(int c, const int16_t* natural) {
    int16_t zigzag[64];
    uint64_t nonzero = 0;
    for (size_t k = 0; k < 64; ++k) {
      zigzag[k] = natural[kNaturalFromZigzag[k]];
      if (zigzag[k] != 0) nonzero |= uint64_t{1} << k;
      if (k > 0 && std::abs(zigzag[k]) > 1023) return false;
    }
    const int difference = zigzag[0] - dc_[c];
    if (std::abs(difference) > 2047) return false;
    dc_[c] = zigzag[0];
    out_ = tokenize_block(zigzag, nonzero, difference, c == 0 ? kDc0 : kDc1, histogram_, out_);
    return true;
  }

  const CoefficientImage& image_;
  const Frame& frame_;
  int restart_interval_;
  TokenBuffer tokens_;
  Token* out_ = nullptr;
  Histogram histogram_;
  int dc_[kMaxComponents] = {};
};

// Adobe's APP14 tells the colors of files that JFIF does not know [as the IJG software writes it].
void write_adobe(ColorModel color, ByteSink& sink) {
  constexpr uint8_t kStart[] = {'A', 'd', 'o', 'b', 'e', 0, 100, 0, 0, 0, 0};  // version, two flags
  sink.put16(0xFF00 | kApp14);
  sink.put16(14);
  sink.append(kStart);
  sink.put(color == ColorModel::ycck ? 2 : 0);
}

void write_tables(const CoefficientImage& image, const Frame& frame, const ScanTables& huffman, ByteSink& sink) {
  bool is_written[kMaxComponents] = {}, is_wide = false;
  for (int i = 0; i < frame.n_components; ++i) {
    const QuantTable& steps = image.components[static_cast<size_t>(i)].steps;
    const int id = frame.components[i].quant_table;
    if (!is_written[id]) write_dqt(steps, id, sink);
    is_written[id] = true;
    is_wide = is_wide || *std::max_element(steps.begin(), steps.end()) > 255;
  }
  write_start_of_frame(is_wide ? kSof1 : kSof0, frame, sink);
  for (int i = 0; i < (frame.n_components > 1 ? kTableCount : 2); ++i) write_dht(huffman.spec[i], i & 1, i >> 1, sink);
}

}  // namespace

Result<CoefficientsRead> read_coefficients(std::span<const uint8_t> file, const DecodeOptions& options, bool lenient) {
  DecodeRequest request;
  request.limits = options.limits;
  request.makes_image = false;
  request.wanted = Wanted::levels;
  const auto decoder = std::make_unique<ScanDecoder>(kernels_of(options.isa));
  PAC_CHECK(decoder->open(file, request));
  PAC_CHECK(decoder->decode({}, lenient));
  const Headers& headers = decoder->headers();
  CoefficientsRead out;
  out.failure = decoder->first_failure();
  out.errors = decoder->errors();
  out.warnings = decoder->warnings();
  out.image.width = headers.frame.width;
  out.image.height = headers.frame.height;
  out.image.color = headers.info.color;
  for (int i = 0; i < headers.frame.n_components; ++i) {
    const Component& c = headers.frame.components[i];
    CoefficientPlane plane;
    plane.id = c.id;
    plane.h = c.h;
    plane.v = c.v;
    plane.width_blocks = c.padded_width_blocks;
    plane.height_blocks = c.padded_height_blocks;
    std::copy_n(decoder->steps(i), 64, plane.steps.begin());
    plane.levels = decoder->take_levels(i);
    out.image.components.push_back(std::move(plane));
  }
  return out;
}

Result<std::vector<uint8_t>> write_coefficients(const CoefficientImage& image, const CoefficientWriteOptions& options) {
  PAC_TRY(const Frame frame, frame_of(image));
  if (options.restart_interval_mcus < 0 || options.restart_interval_mcus > 65535)
    return bad("restart interval is not within 0..65535");
  const Metadata metadata = options.metadata != nullptr ? *options.metadata : Metadata{};
  PAC_CHECK(check_metadata(metadata));
  const bool one_scan = frame.n_components == 1 || blocks_in_mcu(frame) <= kMaxBlocksInMcu;
  const int n_scans = one_scan ? 1 : frame.n_components, n_in_scan = one_scan ? frame.n_components : 1;
  ScanTokens tokens(image, frame, options.restart_interval_mcus);
  size_t ends[kMaxComponents] = {};
  for (int scan = 0; scan < n_scans; ++scan) {
    if (!tokens.add_scan(scan, n_in_scan)) return bad("a coefficient is larger than a baseline file can hold");
    ends[scan] = tokens.size();
  }
  const ScanTables tables =
      options.huffman == Huffman::optimal ? optimal_tables(tokens.histogram()) : fixed_tables(options.huffman);
  std::vector<uint8_t> bytes;
  ByteSink sink(bytes);
  write_start_of_image(sink);
  if (image.color == ColorModel::ycc || image.color == ColorModel::gray) write_jfif(metadata.density, sink);
  write_metadata(metadata, sink);
  if (image.color != ColorModel::ycc && image.color != ColorModel::gray) write_adobe(image.color, sink);
  write_tables(image, frame, tables, sink);
  write_dri(options.restart_interval_mcus, sink);
  ScanWriter writer;
  for (int scan = 0; scan < n_scans; ++scan) {
    write_start_of_scan(frame, scan, n_in_scan, sink);
    writer.begin(tables, false, sink);
    writer.write(tokens.begin() + (scan == 0 ? 0 : ends[scan - 1]), tokens.begin() + ends[scan]);
    writer.finish();
  }
  write_end_of_image(sink);
  return bytes;
}

void requantize(CoefficientImage& image, const QuantTables& steps) {
  for (size_t i = 0; i < image.components.size(); ++i) {
    CoefficientPlane& plane = image.components[i];
    const QuantTable& to = i == 1 || i == 2 ? steps.chroma : steps.luma;
    for (size_t k = 0; k < plane.levels.size(); ++k) {
      const int value = plane.levels[k] * plane.steps[k & 63], step = to[k & 63];
      const int magnitude = (2 * std::abs(value) + step) / (2 * step);
      plane.levels[k] = static_cast<int16_t>(std::min(magnitude, 32767) * (value < 0 ? -1 : 1));
    }
    plane.steps = to;
  }
}

}  // namespace pac::jpeg
