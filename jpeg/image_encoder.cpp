#include "jpeg/image_encoder.h"

#include <cmath>

#include "base/kernels/kernels.h"
#include "jpeg/marker_writer.h"
#include "jpeg/quantizer.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// Costs for every symbol that can occur, also those that did not yet: counts are scaled up and each gets one more.
void smooth(uint32_t (&counts)[256]) {
  constexpr uint32_t kWeight = 64;
  for (uint32_t symbol = 0; symbol < 256; ++symbol) {
    const uint32_t size = symbol & 15;
    if (size == 0 && symbol != 0 && symbol != 0xF0) continue;
    if (size > 10) continue;
    counts[symbol] = counts[symbol] * kWeight + 1;
  }
}

}  // namespace

Result<void> check_options(const SourceImage& image, const EncodeOptions& options) {
  const auto bad = [](const char* text) { return Failure{Error::bad_argument, 0, text}; };
  if (image.width() < 1 || image.height() < 1 || image.width() > 65535 || image.height() > 65535)
    return bad("JPEG image sides are 1..65535");
  if (!(options.quality > 0.0 && options.quality <= 100.0)) return bad("quality is not within (0, 100]");
  if (!(options.dead_zone >= 0.0 && options.dead_zone <= 0.49)) return bad("dead zone is not within 0..0.49");
  if (options.restart_interval_mcus < 0 || options.restart_interval_mcus > 65535)
    return bad("restart interval is not within 0..65535");
  if (!options.tables) return {};
  for (const QuantTable* table : {&options.tables->luma, &options.tables->chroma})
    for (const uint16_t step : *table)
      if (step < 1 || step > 255) return bad("quantizer step is not within 1..255");
  return {};
}

void ImageEncoder::start(const SourceImage& image, const EncodeOptions& options, bool keep_coefficients) {
  options_ = options;
  const Kernels* table = kernels_for(options.isa);
  kernels_ = table != nullptr ? table : &kernels();
  const bool design = !options.tables && options.table_source == TableSource::adapted;
  source_.reset(image, options.subsampling, *kernels_, keep_coefficients || design || options.trellis);
  if (design) designer_.measure(source_);
}

QuantTables ImageEncoder::tables_at(double quality, bool scale_tables) const {
  if (options_.tables) return scale_tables ? scaled_tables(reference_of(*options_.tables), quality) : *options_.tables;
  switch (options_.table_source) {
    case TableSource::tuned:
      return tuned_tables(options_.tune, quality);
    case TableSource::adapted:
      return designer_.at_quality(options_.tune, quality);
    default:
      return annex_k_tables(quality);
  }
}

void ImageEncoder::set_up(const QuantTables& tables, double quality) {
  const bool designed = !options_.tables && options_.table_source == TableSource::adapted;
  const ReferenceSteps reference = designed ? tuned_reference(options_.tune, quality) : reference_of(tables);
  quantizers_[0] = make_quantizer(tables.luma, options_.dead_zone);
  quantizers_[1] = make_quantizer(tables.chroma, options_.dead_zone);
  weights_[0] = trellis_weights(tables.luma, reference.luma);
  weights_[1] = trellis_weights(tables.chroma, reference.chroma);
  use_trellis_ = false;
  const Frame& frame = source_.frame();
  for (int c = 0; c < frame.n_components; ++c) {
    const size_t n = source_.n_blocks(c, 0);  // the first MCU row has most
    levels_.zigzag[c].resize(64 * n);
    levels_.nonzero[c].resize(n);
  }
  tokenizer_.reset(frame, options_.restart_interval_mcus);
}

// Levels of one MCU row, rounded or, once the costs are known, optimized.
void ImageEncoder::quantize(int mcu_row) {
  source_.quantize(mcu_row, quantizers_, levels_);
  for (int c = 0; use_trellis_ && c < source_.frame().n_components; ++c) {
    const size_t n = source_.n_blocks(c, mcu_row), set = c == 0 ? 0 : 1;
    for (size_t i = 0; i < n; ++i) {
      const int16_t* coefficients = source_.row(c) + 64 * i;
      trellis_quantize(coefficients, weights_[set], importance_of(c, coefficients), costs_[set],
                       levels_.zigzag[c].data() + 64 * i, levels_.nonzero[c][i]);
    }
  }
}

// Errors hide in busy blocks of luma; squared error knows nothing of it.
void ImageEncoder::measure_visibility() {
  mean_visibility_ = 0;
  const bool is_tuned = !options_.tables && options_.table_source != TableSource::annex_k;
  if (!is_tuned || options_.tune == Tune::psnr) return;
  double sum = 0;
  size_t n_blocks = 0;
  for (int row = 0; row < source_.frame().mcu_rows; ++row) {
    source_.load(row);
    const size_t n = source_.n_blocks(0, row);
    for (size_t i = 0; i < n; ++i) sum += visibility(source_.row(0) + 64 * i);
    n_blocks += n;
  }
  mean_visibility_ = sum / static_cast<double>(n_blocks);
}

double ImageEncoder::importance_of(int c, const int16_t* coefficients) const {
  if (c > 0 || mean_visibility_ == 0) return 1.0;
  const double ratio = visibility(coefficients) / mean_visibility_;
  // More of it gains nothing in SSIMULACRA 2.1 and costs squared error.
  return options_.tune == Tune::visual ? std::sqrt(ratio) : ratio;
}

// What symbols cost: the standard tables' lengths, or those of tables made for the plainly quantized image.
void ImageEncoder::measure_costs() {
  ScanTables tables = standard_tables();
  if (options_.huffman == Huffman::optimal) {
    for (int row = 0; row < source_.frame().mcu_rows; ++row) {
      quantize(row);
      tokenizer_.add_mcu_row(row, levels_);
    }
    Histogram histogram = tokenizer_.histogram();
    tokenizer_.reset(source_.frame(), options_.restart_interval_mcus);
    smooth(histogram.count[kAc0]);
    smooth(histogram.count[kAc1]);
    tables = optimal_tables(histogram);
  }
  costs_[0] = ac_costs(tables.spec[kAc0]);
  costs_[1] = ac_costs(tables.spec[kAc1]);
  // From here on candidates start at the nearest level: the trellis itself decides what is worth less.
  use_trellis_ = true;
}

void ImageEncoder::write_file(const QuantTables& tables, double quality, ByteSink& sink) {
  set_up(tables, quality);
  if (options_.trellis) {
    measure_visibility();
    measure_costs();
    quantizers_[0] = make_quantizer(tables.luma, 0.0);
    quantizers_[1] = make_quantizer(tables.chroma, 0.0);
  }
  const int restart = options_.restart_interval_mcus;
  const bool one_pass = options_.huffman == Huffman::standard;
  ScanTables scan_tables = standard_tables();
  if (one_pass) {
    write_headers(source_.frame(), tables, scan_tables, restart, sink);
    writer_.begin(scan_tables, true, sink);
    walker_.reset(source_.frame(), restart);
  }
  for (int row = 0; row < source_.frame().mcu_rows; ++row) {
    quantize(row);
    if (one_pass)
      writer_.write_mcu_row(row, levels_, walker_);
    else
      tokenizer_.add_mcu_row(row, levels_);
  }
  if (!one_pass) {
    scan_tables = optimal_tables(tokenizer_.histogram());
    write_headers(source_.frame(), tables, scan_tables, restart, sink);
    writer_.begin(scan_tables, false, sink);
    writer_.write(tokenizer_.begin(), tokenizer_.end());
  }
  writer_.finish();
  write_end_of_image(sink);
}

}  // namespace pac::jpeg
