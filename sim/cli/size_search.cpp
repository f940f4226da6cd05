#include "sim/cli/size_search.h"

#include <algorithm>

namespace pac::cli {
namespace {

constexpr size_t kWindow = 6;

}  // namespace

Result<CodedFile> finest_that_fits(const EncodeAtQuality& encode, std::span<const double> qualities,
                                   uint64_t max_bytes) {
  PAC_ASSERT(!qualities.empty());
  PAC_TRY(Bytes best, encode(qualities.back()));
  if (best.size() > max_bytes)
    return Failure{Error::bad_argument, 0, "cannot be coded in so few bytes, not even at the coarsest tables"};
  size_t too_large = 0, fits = qualities.size() - 1;  // the finest may fit as well: the window looks
  while (too_large + 1 < fits) {
    const size_t middle = too_large + (fits - too_large) / 2;
    PAC_TRY(Bytes bytes, encode(qualities[middle]));
    if (bytes.size() > max_bytes) {
      too_large = middle;
    } else {
      fits = middle;
      best = std::move(bytes);
    }
  }
  for (size_t i = fits - std::min(kWindow, fits); i < fits; ++i) {
    PAC_TRY(Bytes bytes, encode(qualities[i]));
    if (bytes.size() <= max_bytes) return CodedFile{std::move(bytes), qualities[i]};
  }
  return CodedFile{std::move(best), qualities[fits]};
}

}  // namespace pac::cli
