#include "jpeg/quality.h"

#include <cstdint>

namespace pac::jpeg {
namespace {

int64_t distance(const QuantTable& a, const QuantTable& b) {
  int64_t sum = 0;
  for (size_t i = 0; i < 64; ++i) sum += a[i] < b[i] ? b[i] - a[i] : a[i] - b[i];
  return sum;
}

}  // namespace

double estimate_quality(const QuantTable& luma) {
  // First the nearest whole quality, then tenths around it.
  int whole = 1;
  int64_t best = INT64_MAX;
  for (int quality = 1; quality <= 100; ++quality) {
    const int64_t d = distance(luma, annex_k_tables(quality).luma);
    if (d < best) whole = quality;
    best = d < best ? d : best;
  }
  int first = 10 * whole, last = 10 * whole;
  for (int tenths = 10 * whole - 10; tenths <= 10 * whole + 10; ++tenths) {
    if (tenths < 1 || tenths > 1000) continue;
    const int64_t d = distance(luma, annex_k_tables(tenths / 10.0).luma);
    if (d < best) first = tenths;
    if (d <= best) last = tenths;
    best = d < best ? d : best;
  }
  // Whole qualities are what encoders are given: prefer one inside the run of equals.
  const bool whole_is_best = distance(luma, annex_k_tables(whole).luma) == best;
  return whole_is_best ? whole : (first + last) / 2 / 10.0;
}

}  // namespace pac::jpeg
