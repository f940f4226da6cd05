#include "sim/match.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>

#include "base/parallel.h"
#include "sim/table_family.h"

namespace pac::sim {

namespace {

// A picture, what it holds, and how the viewer will see it.
struct Source {
  ConstRgbView image;
  Content content;
  ConstRgbView seen;  // empty: `image`
};

jpeg::EncodeOptions encode_options(const Source& source, const jpeg::QuantTables& tables,
                                   const CodingOptions& options) {
  const bool is_difference = source.content == Content::difference;
  jpeg::EncodeOptions encode;
  encode.tables = tables;
  encode.subsampling = options.subsampling;
  encode.huffman = options.huffman;
  if (options.huffman == jpeg::Huffman::difference && !is_difference) encode.huffman = jpeg::Huffman::standard;
  const bool has_weights = options.masking != jpeg::Tune::psnr || !options.importance.empty();
  if (options.tables == TableFamily::adapted && has_weights) {
    encode.trellis = true;
    encode.masking = options.masking;
    encode.importance = options.importance;
    if (is_difference) encode.seen = source.seen;
  }
  encode.isa = options.isa;
  return encode;
}

// `quality` written with the fewest decimals that still select the tables it selects.
double shortest_quality(double quality, const ScaledTables& family) {
  const jpeg::QuantTables tables = family.at_quality(quality);
  double unit = 1;
  for (int decimals = 0; decimals < 9; ++decimals, unit *= 10) {
    const double rounded = std::floor(quality * unit + 0.5) / unit;
    if (rounded > 0 && rounded <= 100 && same_tables(family.at_quality(rounded), tables)) return rounded;
  }
  return quality;
}

// Sizes of one image's files over the steps of its table family, each coded at most once. Index 0 is the finest step.
class SizeSearch {
 public:
  SizeSearch(const Source& source, const ScaledTables& family, uint64_t target, const CodingOptions& options)
      : source_(source),
        family_(family),
        target_(target),
        options_(options),
        qualities_(family.step_qualities()),
        sizes_(qualities_.size()),
        pool_(options.threads) {}

  // The best step, or the first failure to encode.
  Result<double> run() {
    PAC_TRY(const size_t crossing, bisect());
    for (size_t distance = 0; distance < kWindow && !exact_hit(); distance += kChunk / 2) {
      std::vector<size_t> chunk;
      for (size_t k = distance; k < distance + kChunk / 2; ++k) {
        if (crossing >= k) chunk.push_back(crossing - k);
        if (crossing + 1 + k < sizes_.size()) chunk.push_back(crossing + 1 + k);
      }
      PAC_CHECK(measure(chunk));
    }
    return qualities_[best()];
  }
  int encodes() const { return encodes_; }

 private:
  // Steps looked at on each side of the crossing, and how many are coded between two looks for an exact hit: fixed, so
  // that the answer does not depend on the number of threads. At q15 a step changes the size by about a byte.
  static constexpr size_t kWindow = 24, kChunk = 8;

  // A step with size > target whose successor's is <= target, by size alone; ends of the list where there is none.
  Result<size_t> bisect() {
    size_t low = 0, high = sizes_.size() - 1;
    PAC_CHECK(measure({low, high}));
    if (*sizes_[low] <= target_) return low;
    if (*sizes_[high] > target_) return high;
    while (high - low > 1) {
      const size_t middle = low + (high - low) / 2;
      PAC_CHECK(measure({middle}));
      (*sizes_[middle] > target_ ? low : high) = middle;
    }
    return low;
  }

  Result<void> measure(std::vector<size_t> steps) {
    std::erase_if(steps, [this](size_t step) { return sizes_[step].has_value(); });
    std::vector<std::optional<Failure>> failures(steps.size());
    pool_.for_each(static_cast<int64_t>(steps.size()), [&](int64_t i) {
      const size_t step = steps[static_cast<size_t>(i)];
      auto file = jpeg::encode(source_.image, encode_options(source_, family_.at_quality(qualities_[step]), options_));
      if (file.ok())
        sizes_[step] = file->size();
      else
        failures[static_cast<size_t>(i)] = file.failure();
    });
    encodes_ += static_cast<int>(steps.size());
    for (const auto& failure : failures)
      if (failure) return *failure;
    return {};
  }

  uint64_t distance(size_t step) const {
    const uint64_t size = *sizes_[step];
    return size > target_ ? size - target_ : target_ - size;
  }
  bool exact_hit() const {
    return std::any_of(sizes_.begin(), sizes_.end(), [this](const auto& size) { return size == target_; });
  }
  // Nearest; then smaller; then finer (the lower index, which comes first).
  size_t best() const {
    std::optional<size_t> best;
    for (size_t step = 0; step < sizes_.size(); ++step) {
      if (!sizes_[step]) continue;
      if (!best || distance(step) < distance(*best) ||
          (distance(step) == distance(*best) && *sizes_[step] < *sizes_[*best]))
        best = step;
    }
    return *best;
  }

  const Source& source_;
  const ScaledTables& family_;
  uint64_t target_;
  const CodingOptions& options_;
  std::vector<double> qualities_;
  std::vector<std::optional<uint64_t>> sizes_;
  ThreadPool pool_;
  int encodes_ = 0;
};

Result<CodedImage> code(const Source& source, double quality, const ScaledTables& family,
                        const CodingOptions& options) {
  CodedImage coded;
  coded.quality = quality;
  coded.equivalent_quality = equivalent_quality(quality, source.content);
  coded.tables = family.at_quality(quality);
  PAC_TRY(coded.bytes, jpeg::encode(source.image, encode_options(source, coded.tables, options)));
  coded.encodes = 1;
  return coded;
}

}  // namespace

double scale_from_quality(double quality) {
  PAC_ASSERT(quality > 0 && quality <= 100);
  return quality < 50 ? 5000 / quality : 200 - 2 * quality;
}

double quality_from_scale(double scale_percent) {
  PAC_ASSERT(scale_percent >= 0);
  return scale_percent > 100 ? 5000 / scale_percent : 100 - scale_percent / 2;
}

double equivalent_quality(double coded_quality, Content content) {
  if (content == Content::image) return coded_quality;
  return quality_from_scale(2 * scale_from_quality(coded_quality));
}

double coded_quality(double equivalent_quality, Content content) {
  if (content == Content::image) return equivalent_quality;
  return quality_from_scale(scale_from_quality(equivalent_quality) / 2);
}

Result<CodedImage> code_at_quality(ConstRgbView image, Content content, double quality, const CodingOptions& options,
                                   ConstRgbView seen) {
  if (!(quality > 0 && quality <= 100)) return Failure{Error::bad_argument, 0, "quality must be in (0, 100]"};
  PAC_TRY(const ScaledTables family,
          ScaledTables::create(image, options.tables, options.subsampling, options.importance));
  return code({image, content, seen}, quality, family, options);
}

Result<CodedImage> code_at_size(ConstRgbView image, Content content, uint64_t target_bytes,
                                const CodingOptions& options, ConstRgbView seen) {
  PAC_TRY(const ScaledTables family,
          ScaledTables::create(image, options.tables, options.subsampling, options.importance));
  const Source source{image, content, seen};
  SizeSearch search(source, family, target_bytes, options);
  PAC_TRY(const double quality, search.run());
  PAC_TRY(CodedImage coded, code(source, shortest_quality(quality, family), family, options));
  coded.encodes += search.encodes();
  return coded;
}

}  // namespace pac::sim
