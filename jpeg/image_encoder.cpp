#include "jpeg/image_encoder.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/kernels/kernels.h"
#include "jpeg/marker_writer.h"
#include "jpeg/metadata.h"
#include "jpeg/quantizer.h"
#include "jpeg/stream_tables.h"
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
  if (options.threads < 0 || options.threads > 1024) return bad("thread count is not within 0..1024");
  if (options.sampling && options.subsampling != Subsampling::gray) {
    int n_blocks = 0;
    for (size_t i = 0; i < 3; ++i) {
      const int h = options.sampling->h[i], v = options.sampling->v[i];
      if (h < 1 || h > 4 || v < 1 || v > 4) return bad("sampling factor is not within 1..4");
      n_blocks += h * v;
    }
    if (n_blocks > kMaxBlocksInMcu) return bad("sampling factors make more than 10 blocks in an MCU");
  }
  if (options.metadata != nullptr) PAC_CHECK(check_metadata(*options.metadata));
  if (!options.tables) return {};
  for (const QuantTable* table : {&options.tables->luma, &options.tables->chroma})
    for (const uint16_t step : *table)
      if (step < 1 || step > 255) return bad("quantizer step is not within 1..255");
  return {};
}

// Bands begin where a restart marker stands at the start of a row: predictions and bits begin anew there. Some more
// than there are threads: their work differs.
void ImageEncoder::split(const Frame& frame) {
  constexpr int kBandsPerThread = 8;
  const int n_threads = options_.threads == 0 ? hardware_thread_count() : options_.threads;
  const int interval = options_.restart_interval_mcus;
  int n_bands = 1, period = frame.mcu_rows;
  if (n_threads > 1 && interval > 0) {
    period = interval / std::gcd(interval, frame.mcus_per_row);
    n_bands = std::min(ceil_div(frame.mcu_rows, period), kBandsPerThread * n_threads);
  }
  bands_.resize(static_cast<size_t>(n_bands));
  const int n_periods = ceil_div(frame.mcu_rows, period);
  for (int i = 0; i < n_bands; ++i) {
    Band& band = bands_[static_cast<size_t>(i)];
    band.first_row = static_cast<int>(int64_t{n_periods} * i / n_bands) * period;
    band.end_row = std::min(static_cast<int>(int64_t{n_periods} * (i + 1) / n_bands) * period, frame.mcu_rows);
  }
  if (n_bands > 1 && (!pool_ || pool_->thread_count() != n_threads)) pool_.emplace(n_threads);
}

template <class Fn>
void ImageEncoder::for_each_band(Fn&& fn) {
  if (bands_.size() == 1)
    fn(bands_[0]);
  else
    pool_->for_each(static_cast<int64_t>(bands_.size()), [&](int64_t i) { fn(bands_[static_cast<size_t>(i)]); });
}

void ImageEncoder::start(const SourceImage& image, const EncodeOptions& options, bool keep_coefficients) {
  options_ = options;
  const Kernels* table = kernels_for(options.isa);
  kernels_ = table != nullptr ? table : &kernels();
  const bool design = !options.tables && options.stream == nullptr && options.table_source == TableSource::adapted;
  if (image.pulled != nullptr || image.pixels.data != nullptr) options_.threads = 1;
  const Frame frame = make_frame(image, options);
  split(frame);
  for_each_band([&](Band& band) {
    band.source.reset(image, frame, *kernels_, keep_coefficients || design || options.trellis, band.first_row,
                      band.end_row);
  });
  if (!design) return;
  designer_.reset();
  for (Band& band : bands_) designer_.add_rows(band.source, band.first_row, band.end_row);
}

ScanTables ImageEncoder::known_tables() const {
  return options_.stream != nullptr ? options_.stream->state().huffman : standard_tables();
}

QuantTables ImageEncoder::tables_at(double quality, bool scale_tables) const {
  if (options_.stream != nullptr) return options_.stream->steps();
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
  for (Band& band : bands_) {
    const Frame& frame = band.source.frame();
    for (int c = 0; c < frame.n_components; ++c) {
      const size_t n = band.source.n_blocks(c, band.first_row);  // the first MCU row has most
      band.levels.zigzag[c].resize(64 * n);
      band.levels.nonzero[c].resize(n);
    }
  }
}

// Levels of one MCU row, rounded or, once the costs are known, optimized.
void ImageEncoder::quantize(Band& band, int mcu_row) {
  band.source.quantize(mcu_row, quantizers_, band.levels);
  for (int c = 0; use_trellis_ && c < band.source.frame().n_components; ++c) {
    const size_t n = band.source.n_blocks(c, mcu_row), set = c == 0 ? 0 : 1;
    for (size_t i = 0; i < n; ++i) {
      const int16_t* coefficients = band.source.row(c) + 64 * i;
      trellis_quantize(coefficients, weights_[set], importance_of(c, coefficients), costs_[set],
                       band.levels.zigzag[c].data() + 64 * i, band.levels.nonzero[c][i]);
    }
  }
}

void ImageEncoder::tokenize(Band& band) {
  band.tokenizer.reset(band.source.frame(), options_.restart_interval_mcus, band.first_row);
  for (int row = band.first_row; row < band.end_row; ++row) {
    quantize(band, row);
    band.tokenizer.add_mcu_row(row, band.levels);
  }
}

Histogram ImageEncoder::histogram() {
  for_each_band([&](Band& band) { tokenize(band); });
  Histogram sum;
  for (const Band& band : bands_) band.tokenizer.add_histogram(sum);
  return sum;
}

// Errors hide in busy blocks of luma; squared error knows nothing of it.
void ImageEncoder::measure_visibility() {
  mean_visibility_ = 0;
  const bool is_tuned = !options_.tables && options_.table_source != TableSource::annex_k;
  if (!is_tuned || options_.tune == Tune::psnr) return;
  double sum = 0;
  size_t n_blocks = 0;
  for (Band& band : bands_) {
    for (int row = band.first_row; row < band.end_row; ++row) {
      band.source.load(row);
      const size_t n = band.source.n_blocks(0, row);
      for (size_t i = 0; i < n; ++i) sum += visibility(band.source.row(0) + 64 * i);
      n_blocks += n;
    }
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
  ScanTables tables = known_tables();
  if (options_.huffman == Huffman::optimal && options_.stream == nullptr) {
    Histogram counts = histogram();
    smooth(counts.count[kAc0]);
    smooth(counts.count[kAc1]);
    tables = optimal_tables(counts);
  }
  costs_[0] = ac_costs(tables.spec[kAc0]);
  costs_[1] = ac_costs(tables.spec[kAc1]);
  // From here on candidates start at the nearest level: the trellis itself decides what is worth less.
  use_trellis_ = true;
}

void ImageEncoder::prepare(const QuantTables& tables, double quality) {
  set_up(tables, quality);
  if (!options_.trellis) return;
  measure_visibility();
  measure_costs();
  quantizers_[0] = make_quantizer(tables.luma, 0.0);
  quantizers_[1] = make_quantizer(tables.chroma, 0.0);
}

Histogram ImageEncoder::count_symbols(const QuantTables& tables, double quality) {
  prepare(tables, quality);
  return histogram();
}

void ImageEncoder::write_file(const QuantTables& tables, double quality, ByteSink& sink) {
  prepare(tables, quality);
  // With known tables levels become bits at once; else all tokens wait for the tables made of them.
  const bool direct = options_.huffman == Huffman::standard || options_.stream != nullptr;
  const ScanTables scan_tables = direct ? known_tables() : optimal_tables(histogram());
  write_headers(bands_[0].source.frame(), tables, scan_tables, options_, sink);
  write_entropy_coded(scan_tables, direct, sink);
  write_end_of_image(sink);
}

void ImageEncoder::write_entropy_coded(const ScanTables& tables, bool direct, ByteSink& sink) {
  if (bands_.size() == 1) {
    write_band(bands_[0], tables, direct, sink);
    return;
  }
  for_each_band([&](Band& band) {
    band.bytes.clear();
    ByteSink own(band.bytes);
    write_band(band, tables, direct, own);
  });
  for (const Band& band : bands_) sink.append(band.bytes);
}

// A later band begins with its restart marker, the one before ends with padding: together the bytes of one scan.
void ImageEncoder::write_band(Band& band, const ScanTables& tables, bool direct, ByteSink& sink) {
  band.writer.begin(tables, direct, sink);
  if (direct) {
    band.walker.reset(band.source.frame(), options_.restart_interval_mcus, band.first_row);
    for (int row = band.first_row; row < band.end_row; ++row) {
      quantize(band, row);
      band.writer.write_mcu_row(row, band.levels, band.walker);
    }
  } else {
    band.writer.write(band.tokenizer.begin(), band.tokenizer.end());
  }
  band.writer.finish();
}

}  // namespace pac::jpeg
