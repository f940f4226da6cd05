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
  int64_t best = INT64_MAX;
  int first = 0, last = 0;  // in tenths
  for (int tenths = 1; tenths <= 1000; ++tenths) {
    const int64_t d = distance(luma, annex_k_tables(tenths / 10.0).luma);
    if (d < best) first = tenths;
    if (d <= best) last = tenths;
    best = d < best ? d : best;
  }
  // Integer qualities are what encoders are given: prefer one inside the run.
  const int middle = (first + last) / 2, whole = (middle + 5) / 10 * 10;
  return (whole >= first && whole <= last ? whole : middle) / 10.0;
}

}  // namespace pac::jpeg
