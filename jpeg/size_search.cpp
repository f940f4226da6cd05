// The largest real-valued quality whose file fits.
#include <vector>

#include "jpeg/image_encoder.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {
namespace {

bool equal(const QuantTables& a, const QuantTables& b) {
  return a.luma == b.luma && a.chroma == b.chroma;
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
    int low = 1, high = 100 * units_per_quality_ + 1;  // low fits
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (size_at(middle) <= target_ ? low : high) = middle;
    }
    return scan_upwards(low);
  }

 private:
  struct Tried {
    int units;
    QuantTables tables;
    uint64_t size;
  };

  uint64_t size_of(int units, const QuantTables& tables) {
    for (const Tried& tried : tried_)
      if (tried.units == units || (tables_decide_ && equal(tried.tables, tables))) return tried.size;
    ByteSink counter;
    encoder_.write_file(tables, quality_of(units), counter);
    tried_.push_back({units, tables, counter.size()});
    return counter.size();
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
  file.quality = search.quality_of(units);
  file.tables = search.tables_at(units);
  ByteSink sink(file.bytes);
  encoder.write_file(file.tables, file.quality, sink);
  return file;
}

}  // namespace pac::jpeg
