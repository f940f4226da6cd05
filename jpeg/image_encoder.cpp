#include "jpeg/image_encoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/kernels/kernels.h"
#include "jpeg/bands.h"
#include "jpeg/marker_writer.h"
#include "jpeg/metadata.h"
#include "jpeg/quantizer.h"
#include "jpeg/stream_tables.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// Tables with a code for every symbol that can occur, also those that did not yet.
ScanTables complete_tables(const Histogram& histogram) {
  ScanTables tables;
  for (uint32_t i = 0; i < kTableCount; ++i) {
    uint64_t counts[256];
    for (size_t symbol = 0; symbol < 256; ++symbol) counts[symbol] = histogram.count[i][symbol];
    tables.spec[i] = complete_huffman(i == kDc0 || i == kDc1, counts);
  }
  return tables;
}

// Statistics of the trellis look at about so many blocks, those of DC alone at fewer.
constexpr int64_t kSampledBlocks = 12288, kFewBlocks = 3072;

bool is_sampled(int mcu_row, int period) {
  return mcu_row % period == period / 2;
}

constexpr ChromaGain kNoGain = [] {
  ChromaGain none{};
  for (double& gain : none.gain) gain = 1.0;
  return none;
}();

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
  if (options.seen.data != nullptr && (options.seen.width != image.width() || options.seen.height != image.height()))
    return bad("the picture to be seen is not of the image's size");
  if (!options.importance.empty()) {
    const size_t n_blocks =
        static_cast<size_t>(ceil_div(image.width(), 8)) * static_cast<size_t>(ceil_div(image.height(), 8));
    if (options.importance.size() != n_blocks) return bad("the importance of blocks is not of the image's size");
    for (const float importance : options.importance)
      if (!(importance > 0.0f && importance <= 1e6f)) return bad("the importance of a block is not within (0, 1e6]");
  }
  if (!options.tables) return {};
  for (const QuantTable* table : {&options.tables->luma, &options.tables->chroma})
    for (const uint16_t step : *table)
      if (step < 1 || step > 255) return bad("quantizer step is not within 1..255");
  return {};
}

// Bands begin where a restart marker stands at the start of a row: predictions and bits begin anew there.
void ImageEncoder::split(const Frame& frame) {
  const int interval = options_.restart_interval_mcus;
  int n_threads = options_.threads == 0 ? hardware_thread_count() : options_.threads, period = frame.mcu_rows;
  if (interval > 0) period = interval / std::gcd(interval, frame.mcus_per_row);
  const int n_periods = ceil_div(frame.mcu_rows, period);
  if (n_periods == 1) n_threads = 1;
  size_t n_bands = 0;
  for (int done = 0; done < n_periods; ++n_bands) {
    if (n_bands == bands_.size()) bands_.emplace_back();
    Band& band = bands_[n_bands];
    band.first_row = done * period;
    done += n_threads == 1 ? n_periods : next_band(n_periods - done, n_periods, n_threads);
    band.end_row = std::min(done * period, frame.mcu_rows);
  }
  bands_.resize(n_bands);
  order_.resize(n_bands);
  std::iota(order_.begin(), order_.end(), size_t{0});
  if (n_bands > 1 && (!pool_ || pool_->thread_count() != n_threads)) pool_.emplace(n_threads);
}

template <class Fn>
void ImageEncoder::for_each_band(Fn&& fn) {
  if (bands_.size() == 1)
    fn(bands_[0]);
  else
    pool_->for_each(static_cast<int64_t>(bands_.size()),
                    [&](int64_t i) { fn(bands_[order_[static_cast<size_t>(i)]]); });
}

void ImageEncoder::start(const SourceImage& image, const EncodeOptions& options, bool keep_coefficients) {
  options_ = options;
  bias_ = 0;
  const Kernels* table = kernels_for(options.isa);
  kernels_ = table != nullptr ? table : &kernels();
  masking_ = options.masking ? *options.masking : is_tuned() ? options.tune : Tune::psnr;
  if (image.pulled != nullptr || image.pixels.data != nullptr) options_.threads = 1;
  const Frame frame = make_frame(image, options);
  const Component &luma = frame.components[0], &chroma = frame.components[frame.n_components - 1];
  chroma_gain_ = is_tuned() ? chroma_gain(options.tune, luma.h == 2 * chroma.h, luma.v == 2 * chroma.v) : kNoGain;
  split(frame);
  const bool is_fitted = is_tuned() && options.table_source == TableSource::fitted;
  // Pulled rows come once.
  const bool keep = keep_coefficients || is_adapted() || options.trellis || (is_fitted && image.pulled != nullptr);
  for_each_band([&](Band& band) { band.source.reset(image, frame, *kernels_, keep, band.first_row, band.end_row); });
  seen_visibility_.clear();
  const bool is_full = luma.h == frame.h_max && luma.v == frame.v_max;
  if (options.seen.data != nullptr && options.trellis && masking_ != Tune::psnr && is_full) measure_seen();
  for (std::vector<float>& of_component : importance_) of_component.clear();
  if (options.trellis && !options.importance.empty()) spread_importance(frame);
  if (is_adapted() || is_fitted) design(!is_adapted());
}

// Of all rows in order, whatever the bands.
void ImageEncoder::design(bool dc_only) {
  const int period = sample_period(dc_only ? kFewBlocks : kSampledBlocks);
  designer_.reset(dc_only);
  for (Band& band : bands_)
    for (int row = band.first_row; row < band.end_row; ++row)
      if (is_sampled(row, period)) designer_.add_row(band.source, row);
  designer_.finish();
}

// Every how many MCU rows statistics look, so that they see about max_blocks.
int ImageEncoder::sample_period(int64_t max_blocks) const {
  const Frame& frame = bands_[0].source.frame();
  int64_t n_blocks = 0;
  for (int c = 0; c < frame.n_components; ++c)
    n_blocks += int64_t{frame.components[c].width_blocks} * frame.components[c].height_blocks;
  return static_cast<int>(std::min<int64_t>((n_blocks + max_blocks - 1) / max_blocks, frame.mcu_rows));
}

ScanTables ImageEncoder::known_tables() const {
  return options_.stream != nullptr ? options_.stream->state().huffman : fixed_tables(options_.huffman);
}

QuantTables ImageEncoder::tables_at(double quality, bool scale_tables) const {
  if (options_.stream != nullptr) return options_.stream->steps();
  if (options_.tables) return scale_tables ? scaled_tables(reference_of(*options_.tables), quality) : *options_.tables;
  switch (options_.table_source) {
    case TableSource::tuned:
      return tuned_tables(options_.tune, quality);
    case TableSource::fitted:
      return designer_.dc_at_quality(options_.tune, quality);
    case TableSource::adapted:
      return designer_.at_quality(options_.tune, quality, chroma_gain_.gain);
    default:
      return annex_k_tables(quality);
  }
}

void ImageEncoder::set_tables(const QuantTables& tables, double dead_zone) {
  quantizers_[0] = make_quantizer(tables.luma, dead_zone, kNoGain.gain);
  quantizers_[1] = make_quantizer(tables.chroma, dead_zone, chroma_gain_.gain);
  if (!options_.trellis) return;
  const double rate = exchange_rates(masking_).trellis * (1.0 - 0.9 * bias_);
  weights_[0] = trellis_weights(tables.luma, reference_.luma, kNoGain.gain, rate);
  weights_[1] = trellis_weights(tables.chroma, reference_.chroma, chroma_gain_.gain, rate);
}

void ImageEncoder::reserve_levels() {
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
  if (use_trellis_) optimize_levels(band, mcu_row);
}

// AC block by block; DC, whose prices depend on their neighbors, along the row.
void ImageEncoder::optimize_levels(Band& band, int mcu_row) {
  const Frame& frame = band.source.frame();
  for (int c = 0; c < frame.n_components; ++c) {
    const size_t n = band.source.n_blocks(c, mcu_row), set = c == 0 ? 0 : 1;
    const int16_t* coefficients = band.source.row(c);
    band.importance.resize(n);
    for (size_t i = 0; i < n; ++i) {
      band.importance[i] = importance_of(band, c, mcu_row, i);
      trellis_quantize(coefficients + 64 * i, weights_[set], band.importance[i], costs_[set],
                       band.levels.zigzag[c].data() + 64 * i, band.levels.nonzero[c][i]);
    }
    band.dc_trellis.choose(frame, c, mcu_row, options_.restart_interval_mcus, coefficients, band.importance.data(),
                           weights_[set], dc_costs_[set], band.levels);
  }
}

void ImageEncoder::add_sums(Band& band, int mcu_row) const {
  for (int c = 0; c < band.source.frame().n_components; ++c) {
    const size_t n = band.source.n_blocks(c, mcu_row), set = c == 0 ? 0 : 1;
    for (size_t i = 0; i < n; ++i) {
      const int16_t* levels = band.levels.zigzag[c].data() + 64 * i;
      for (uint64_t rest = band.levels.nonzero[c][i]; rest != 0; rest &= rest - 1) {
        const int k = std::countr_zero(rest), level = levels[k];
        band.sums.products[set][k] += level * band.source.row(c)[64 * i + kNaturalFromZigzag[k]];
        band.sums.squares[set][k] += level * level;
      }
    }
  }
}

// The sampled rows of a band. Where rows are left out, predictions begin anew in each: what the histogram tells, and so
// the file, must not depend on where bands begin.
void ImageEncoder::tokenize(Band& band, int period) {
  band.sums = {};
  band.tokenizer.reset(band.source.frame(), options_.restart_interval_mcus, band.first_row);
  band.dc_trellis.reset();
  for (int row = band.first_row; row < band.end_row; ++row) {
    if (!is_sampled(row, period)) continue;
    if (period > 1) {
      band.tokenizer.restart_predictions();
      band.dc_trellis.reset();
    }
    quantize(band, row);
    band.tokenizer.add_mcu_row(row, band.levels);
    if (use_trellis_ && is_adapted()) add_sums(band, row);
  }
}

Histogram ImageEncoder::histogram(int period) {
  for_each_band([&](Band& band) { tokenize(band, period); });
  order_bands();
  Histogram sum;
  for (const Band& band : bands_) band.tokenizer.add_histogram(sum);
  return sum;
}

void ImageEncoder::order_bands() {
  const auto n_tokens = [&](size_t i) { return bands_[i].tokenizer.end() - bands_[i].tokenizer.begin(); };
  // Not std::stable_sort(), which allocates.
  std::sort(order_.begin(), order_.end(),
            [&](size_t a, size_t b) { return n_tokens(a) != n_tokens(b) ? n_tokens(a) > n_tokens(b) : a < b; });
}

// Errors hide in busy blocks of luma; squared error knows nothing of it.
void ImageEncoder::measure_visibility(int period) {
  double sum = 0;
  size_t n_blocks = 0;
  for (Band& band : bands_) {
    for (int row = band.first_row; row < band.end_row; ++row) {
      if (!is_sampled(row, period)) continue;
      band.source.load(row);
      const size_t n = band.source.n_blocks(0, row);
      for (size_t i = 0; i < n; ++i) sum += visibility_of(band, row, i);
      n_blocks += n;
    }
  }
  mean_visibility_ = static_cast<float>(sum / static_cast<double>(n_blocks));
}

// What symbols cost: the lengths of fixed tables, or those of tables made for the sample as quantized so far.
void ImageEncoder::measure_costs(int period) {
  ScanTables tables = known_tables();
  const bool is_optimal = options_.huffman == Huffman::optimal && options_.stream == nullptr;
  Histogram counts;
  if (is_optimal || use_trellis_) counts = histogram(period);
  if (is_optimal) tables = complete_tables(counts);
  for (size_t set = 0; set < 2; ++set) {
    costs_[set] = ac_costs(tables.spec[set == 0 ? kAc0 : kAc1]);
    dc_costs_[set] = dc_costs(tables.spec[set == 0 ? kDc0 : kDc1]);
  }
}

// The steps with the least squared error for the levels chosen: centroids, so to speak.
void ImageEncoder::refine(QuantTables& tables) const {
  for (size_t set = 0; set < 2; ++set) {
    QuantTable& table = set == 0 ? tables.luma : tables.chroma;
    const double* gain = set == 0 ? kNoGain.gain : chroma_gain_.gain;
    for (size_t k = 0; k < 64; ++k) {
      int64_t products = 0, squares = 0;
      for (const Band& band : bands_) {
        products += band.sums.products[set][k];
        squares += band.sums.squares[set][k];
      }
      if (squares == 0) continue;
      uint16_t& step = table[kNaturalFromZigzag[k]];
      const double best = effective_gain(gain[kNaturalFromZigzag[k]], step) * static_cast<double>(products) /
                          (kDctScale * static_cast<double>(squares));
      step = static_cast<uint16_t>(std::clamp(static_cast<int>(std::floor(best + 0.5)), 1, 255));
    }
  }
}

// Rounding -> costs of symbols -> trellis -> their costs, and steps, anew. Further rounds gain less than 0.1 %.
void ImageEncoder::optimize(QuantTables& tables, double quality) {
  const int period = sample_period(kSampledBlocks);
  reference_ = is_adapted() ? tuned_reference(options_.tune, quality) : reference_of(tables);
  measure_visibility(period);
  use_trellis_ = false;
  set_tables(tables, dead_zone());
  measure_costs(period);
  // From here on candidates start at the nearest level: the trellis itself decides what is worth less.
  use_trellis_ = true;
  set_tables(tables, 0.0);
  measure_costs(period);
  if (!is_adapted()) return;
  refine(tables);
  set_tables(tables, 0.0);
}

void ImageEncoder::prepare(QuantTables& tables, double quality) {
  reserve_levels();
  use_trellis_ = false;
  if (options_.trellis)
    optimize(tables, quality);
  else
    set_tables(tables, dead_zone());
}

Histogram ImageEncoder::count_symbols(QuantTables tables, double quality) {
  prepare(tables, quality);
  return histogram(1);
}

QuantTables ImageEncoder::write_file(QuantTables tables, double quality, ByteSink& sink) {
  prepare(tables, quality);
  // With known tables levels become bits at once; else all tokens wait for the tables made of them.
  const bool direct = options_.huffman != Huffman::optimal || options_.stream != nullptr;
  const ScanTables scan_tables = direct ? known_tables() : optimal_tables(histogram(1));
  write_headers(bands_[0].source.frame(), tables, scan_tables, options_, sink);
  write_entropy_coded(scan_tables, direct, sink);
  write_end_of_image(sink);
  return tables;
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
    band.dc_trellis.reset();
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
