// The finest quality whose file fits a size.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/file_io.h"

namespace pac::cli {

using EncodeAtQuality = std::function<Result<Bytes>(double quality)>;

struct CodedFile {
  Bytes bytes;
  double quality = 0;
};

// `qualities`: finest first, at least one. Bisects for the place where sizes cross `max_bytes`; size need not fall with
// coarser tables, so it then codes the kWindow finer qualities before that place as well, and takes the finest that
// fits. Fails with bad_argument where not even the coarsest fits, and as `encode`.
Result<CodedFile> finest_that_fits(const EncodeAtQuality& encode, std::span<const double> qualities,
                                   uint64_t max_bytes);

}  // namespace pac::cli
