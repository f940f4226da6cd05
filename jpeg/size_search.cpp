// The largest real-valued quality whose file fits, and what lies between it and the next.
#include <algorithm>
#include <vector>

#include "base/kernels/block_kernels.h"
#include "jpeg/image_encoder.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {
namespace {

bool equal(const QuantTables& a, const QuantTables& b) {
  return a.luma == b.luma && a.chroma == b.chroma;
}

// The finest 0 <= n < end that fits by bisection, where 0 does and `end` does not.
template <class Fits>
int bisect(int end, Fits&& fits) {
  int low = 0, high = end;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

// The first n_finer of the 128 steps from `finer`, the others from `coarser`: lowest frequencies first, luma before
// chroma.
QuantTables mixed(const QuantTables& coarser, const QuantTables& finer, int n_finer) {
  QuantTables tables = coarser;
  for (int i = 0; i < n_finer; ++i) {
    const size_t natural = kNaturalFromZigzag[i / 2];
    if (i % 2 == 0)
      tables.luma[natural] = finer.luma[natural];
    else
      tables.chroma[natural] = finer.chroma[natural];
  }
  return tables;
}

class SizeSearch {
 public:
  // Qualities are tried in `units_per_quality`-ths. `tables_decide`: the file depends on the quality only by its
  // tables.
  SizeSearch(ImageEncoder& encoder, uint64_t target, int units_per_quality, bool tables_decide)
      : encoder_(encoder), target_(target), units_per_quality_(units_per_quality), tables_decide_(tables_decide) {}

  double quality_of(int units) const { return static_cast<double>(units) / units_per_quality_; }
  QuantTables tables_at(int units) const { return encoder_.tables_at(quality_of(units), true); }

  uint64_t size_at(int units) { return size_of(units, tables_at(units)); }

  // The largest quality found to fit, or 0.
  int largest_fitting() {
    if (size_at(1) > target_) return 0;
    const int low = 1 + bisect(100 * units_per_quality_, [&](int n) { return size_at(1 + n) <= target_; });
    return scan_upwards(low);
  }

  // Writes the file of `units`, which fits. Where it leaves more than a hundredth of the target: steps of the next
  // finer tables one after the other, lowest frequencies first, as long as they fit; then sets that do not fit, with
  // levels biased towards 0 as far as they must; then the same with tables finer still.
  void write(int units, SizedFile& file) {
    file.quality = quality_of(units);
    Fill best{tables_at(units), file.quality, 0, size_at(units)};
    const QuantTables coarser = best.tables;
    int next = units;
    for (int i = 0; i < kNextQualities && best.size < enough(); ++i) {
      next = next_larger(next);
      if (next == 0) break;
      fill_up(coarser, next, best);
    }
    file.is_between_qualities = best.quality != file.quality || !equal(best.tables, tables_at(units));
    ByteSink sink(file.bytes);
    encoder_.set_bias(best.bias);
    file.tables = encoder_.write_file(best.tables, best.quality, sink);
    encoder_.set_bias(0);
  }

 private:
  static constexpr int kSteps = 128, kTooFine = 8, kBiases = 256, kNearBiases = 16, kNextQualities = 4;

  // What fills the target best so far.
  struct Fill {
    QuantTables tables;
    double quality, bias;
    uint64_t size;
  };

  struct Tried {
    int units;
    QuantTables tables;
    uint64_t size;
  };

  uint64_t size(const QuantTables& tables, double quality, double bias) {
    ByteSink counter;
    encoder_.set_bias(bias);
    encoder_.write_file(tables, quality, counter);
    encoder_.set_bias(0);
    return counter.size();
  }

  uint64_t size_of(int units, const QuantTables& tables) {
    for (const Tried& tried : tried_)
      if (tried.units == units || (tables_decide_ && equal(tried.tables, tables))) return tried.size;
    const uint64_t bytes = size(tables, quality_of(units), 0);
    tried_.push_back({units, tables, bytes});
    return bytes;
  }

  uint64_t enough() const { return target_ - target_ / 100; }

  // Whether it fits; it becomes `best` if it also fills more.
  bool consider(const QuantTables& tables, double quality, double bias, Fill& best) {
    const uint64_t bytes = size(tables, quality, bias);
    if (bytes <= target_ && bytes > best.size) best = {tables, quality, bias, bytes};
    return bytes <= target_;
  }

  // From these tables towards those of the larger quality `next`, which do not fit.
  void fill_up(const QuantTables& coarser, int next, Fill& best) {
    const QuantTables finer = tables_at(next);
    const auto fits = [&](int n) { return consider(mixed(coarser, finer, n), quality_of(next), 0, best); };
    // With none of the finer steps a quality may still differ by what else depends on it.
    const int n_fitting = fits(0) ? bisect(kSteps + 1, fits) : -1;
    for (int n = n_fitting + 1; n <= std::min(n_fitting + kTooFine, kSteps) && best.size < enough(); ++n)
      bias(mixed(coarser, finer, n), quality_of(next), best);
  }

  // The least bias with which these tables fit, and its neighbors: sizes are not monotonic here either.
  void bias(const QuantTables& tables, double quality, Fill& best) {
    const auto fits = [&](int n) { return consider(tables, quality, 1.0 - static_cast<double>(n) / kBiases, best); };
    if (!fits(0)) return;
    const int least = bisect(kBiases, fits);
    for (int n = least + 2; n <= std::min(least + kNearBiases, kBiases) && best.size < enough(); ++n) fits(n);
  }

  // The next quality of other bytes, 0 if there is none.
  int next_larger(int units) {
    for (int next = units + 1; next <= 100 * units_per_quality_; ++next)
      if (size_at(next) > target_) return next;
    return 0;
  }

  // Finer steps now and then give a shorter file: goes on while sizes are near the target, and over 24 table sets.
  int scan_upwards(int best) {
    constexpr int kTableSets = 24;
    QuantTables previous = tables_at(best);
    int misses = 0;
    for (int units = best + 1; units <= 100 * units_per_quality_; ++units) {
      const QuantTables tables = tables_at(units);
      const bool changed = !equal(tables, previous);
      previous = tables;
      const uint64_t size = size_of(units, tables);
      if (size <= target_) {
        best = units;
        misses = 0;
      } else if (changed && ++misses >= kTableSets && size > target_ + target_ / 32) {
        break;
      }
    }
    return best;
  }

  ImageEncoder& encoder_;
  uint64_t target_;
  int units_per_quality_;
  bool tables_decide_;
  std::vector<Tried> tried_;
};

}  // namespace

Result<SizedFile> encode_to_size(ConstRgbView image, const EncodeOptions& options, uint64_t target_bytes) {
  if (options.stream != nullptr)
    return Failure{Error::bad_argument, 0, "a stream's tables are fixed: no quality to search"};
  EncodeOptions valid = options;
  valid.quality = 50;
  PAC_CHECK(check_options(rgb_image(image), valid));
  ImageEncoder encoder;
  encoder.start(rgb_image(image), valid, true);
  // Adapted tables take a while to design, and the trellis's reference steps move with the quality.
  const bool adapted = !options.tables && options.table_source == TableSource::adapted;
  SizeSearch search(encoder, target_bytes, adapted ? 4 : 100, !adapted);
  const int units = search.largest_fitting();
  if (units == 0)
    return Failure{Error::out_of_space, search.size_at(1), "even the lowest quality is longer than the target"};
  SizedFile file;
  search.write(units, file);
  return file;
}

}  // namespace pac::jpeg
