#include "jpeg/decode_request.h"

namespace pac::jpeg {

const Kernels& kernels_of(Isa isa) {
  const Kernels* table = kernels_for(isa);
  return table != nullptr ? *table : kernels();
}

Result<void> check_options(const DecodeOptions& options) {
  if (options.threads < 0 || options.threads > 1024)
    return Failure{Error::bad_argument, 0, "thread count is not within 0..1024"};
  const int scale = options.scale_denominator;
  if (scale != 1 && scale != 2 && scale != 4 && scale != 8)
    return Failure{Error::bad_argument, 0, "scale denominator is not 1, 2, 4 or 8"};
  return {};
}

DecodeRequest request_of(const DecodeOptions& options) {
  DecodeRequest request;
  request.limits = options.limits;
  request.scale = options.scale_denominator;
  request.crop = options.crop;
  return request;
}

}  // namespace pac::jpeg
