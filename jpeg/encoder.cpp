#include "base/kernels/kernels.h"
#include "jpeg/byte_sink.h"
#include "jpeg/frame.h"
#include "jpeg/jpeg.h"
#include "jpeg/marker_writer.h"
#include "jpeg/quantizer.h"
#include "jpeg/scan_writer.h"
#include "jpeg/strip.h"

namespace pac::jpeg {
namespace {

// One MCU row of levels, or all of them: blocks of component c in rows of width_blocks.
struct Levels {
  std::vector<int16_t> zigzag[3];
  std::vector<uint64_t> nonzero[3];
};

Result<void> check(const SourceImage& image, const EncodeOptions& options) {
  const auto bad = [](const char* text) { return Failure{Error::bad_argument, 0, text}; };
  if (image.width() < 1 || image.height() < 1 || image.width() > 65535 || image.height() > 65535)
    return bad("JPEG image sides are 1..65535");
  if (!(options.quality > 0.0 && options.quality <= 100.0)) return bad("quality is not within (0, 100]");
  if (!(options.dead_zone >= 0.0 && options.dead_zone <= 0.49)) return bad("dead zone is not within 0..0.49");
  if (options.restart_interval_mcus < 0 || options.restart_interval_mcus > 65535)
    return bad("restart interval is not within 0..65535");
  if (options.tables)
    for (const QuantTable* table : {&options.tables->luma, &options.tables->chroma})
      for (const uint16_t step : *table)
        if (step < 1 || step > 255) return bad("quantizer step is not within 1..255");
  return {};
}

// Walks the MCUs of a scan and turns levels into tokens. Keeps the DC predictions and the restart count.
class Tokenizer {
 public:
  Tokenizer(const Frame& frame, int restart_interval_mcus)
      : frame_(frame), restart_interval_(restart_interval_mcus), to_restart_(restart_interval_mcus) {}

  void add_mcu_row(int mcu_row, const Levels& levels, std::vector<Token>& tokens) {
    const size_t first = tokens.size();
    size_t n_max = 0;
    for (int c = 0; c < frame_.n_components; ++c)
      n_max += static_cast<size_t>(frame_.components[c].h * frame_.components[c].v) * kMaxTokensInBlock;
    tokens.resize(first + static_cast<size_t>(frame_.mcus_per_row) * (n_max + 1));
    Token* out = tokens.data() + first;
    for (int mcu = 0; mcu < frame_.mcus_per_row; ++mcu) {
      out = restart_if_due(out);
      for (int c = 0; c < frame_.n_components; ++c) out = add_component(c, mcu_row, mcu, levels, out);
    }
    tokens.resize(static_cast<size_t>(out - tokens.data()));
  }

 private:
  Token* restart_if_due(Token* out) {
    if (restart_interval_ == 0) return out;
    if (to_restart_ == 0) {
      *out++ = kRestartToken | next_restart_;
      next_restart_ = (next_restart_ + 1) & 7;
      to_restart_ = restart_interval_;
      for (int& dc : dc_) dc = 0;
    }
    to_restart_ -= 1;
    return out;
  }

  // Blocks that complete an MCU past the image's edge repeat the DC before them: the cheapest to code.
  Token* add_component(int c, int mcu_row, int mcu, const Levels& levels, Token* out) {
    const Component& component = frame_.components[c];
    const int n_rows = StripTransform::rows_of_blocks(component, mcu_row);
    const uint32_t table = c == 0 ? kDc0 : kDc1;
    for (int by = 0; by < component.v; ++by) {
      for (int bx = mcu * component.h; bx < (mcu + 1) * component.h; ++bx) {
        if (by >= n_rows || bx >= component.width_blocks) {
          out = tokenize_block(nullptr, 0, 0, table, out);
          continue;
        }
        const size_t i =
            static_cast<size_t>(by) * static_cast<size_t>(component.width_blocks) + static_cast<size_t>(bx);
        const int16_t* block = levels.zigzag[c].data() + 64 * i;
        out = tokenize_block(block, levels.nonzero[c][i], block[0] - dc_[c], table, out);
        dc_[c] = block[0];
      }
    }
    return out;
  }

  const Frame& frame_;
  int restart_interval_, to_restart_;
  uint32_t next_restart_ = 0;
  int dc_[3] = {0, 0, 0};
};

void encode_to(const SourceImage& image, const EncodeOptions& options, ByteSink& sink) {
  const Kernels* table = kernels_for(options.isa);
  const Kernels& k = table != nullptr ? *table : kernels();
  const Frame frame = make_frame(image.width(), image.height(), options.subsampling);
  const QuantTables steps = options.tables ? *options.tables : annex_k_tables(options.quality);
  const BlockQuantizer quantizers[2] = {make_quantizer(steps.luma, options.dead_zone),
                                        make_quantizer(steps.chroma, options.dead_zone)};
  StripTransform strips;
  strips.reset(frame, image, k);
  std::vector<int16_t> coefficients[3];
  Levels levels;
  int16_t* out[3] = {};
  for (int c = 0; c < frame.n_components; ++c) {
    const auto n = static_cast<size_t>(frame.components[c].width_blocks) * frame.components[c].v;
    coefficients[c].resize(64 * n);
    levels.zigzag[c].resize(64 * n);
    levels.nonzero[c].resize(n);
    out[c] = coefficients[c].data();
  }
  const bool one_pass = options.huffman == Huffman::standard;
  ScanTables tables = standard_tables();
  std::optional<ScanWriter> writer;
  if (one_pass) {
    write_headers(frame, steps, tables, options.restart_interval_mcus, sink);
    writer.emplace(tables, sink);
  }
  Tokenizer tokenizer(frame, options.restart_interval_mcus);
  std::vector<Token> tokens;
  for (int row = 0; row < frame.mcu_rows; ++row) {
    strips.transform(row, out);
    for (int c = 0; c < frame.n_components; ++c) {
      const Component& component = frame.components[c];
      const auto n = static_cast<size_t>(StripTransform::rows_of_blocks(component, row) * component.width_blocks);
      k.block.quantize(out[c], quantizers[c == 0 ? 0 : 1], n, levels.zigzag[c].data(), levels.nonzero[c].data());
    }
    if (one_pass) tokens.clear();
    tokenizer.add_mcu_row(row, levels, tokens);
    if (one_pass) writer->write(tokens.data(), tokens.data() + tokens.size());
  }
  if (!one_pass) {
    Histogram histogram;
    add_to_histogram(tokens.data(), tokens.data() + tokens.size(), histogram);
    tables = optimal_tables(histogram);
    write_headers(frame, steps, tables, options.restart_interval_mcus, sink);
    writer.emplace(tables, sink);
    writer->write(tokens.data(), tokens.data() + tokens.size());
  }
  writer->finish();
  write_end_of_image(sink);
}

Result<std::vector<uint8_t>> encode_source(const SourceImage& image, const EncodeOptions& options) {
  PAC_CHECK(check(image, options));
  std::vector<uint8_t> bytes;
  ByteSink sink(bytes);
  encode_to(image, options, sink);
  return bytes;
}

}  // namespace

Result<std::vector<uint8_t>> encode(ConstRgbView image, const EncodeOptions& options) {
  return encode_source({image, {}}, options);
}

Result<std::vector<uint8_t>> encode_gray(PlaneView<const uint8_t> image, const EncodeOptions& options) {
  EncodeOptions gray = options;
  gray.subsampling = Subsampling::gray;
  return encode_source({{}, image}, gray);
}

}  // namespace pac::jpeg
