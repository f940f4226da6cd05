// What is wanted of a file, from the public options.
#pragma once

#include <optional>

#include "base/kernels/kernels.h"
#include "jpeg/header_reader.h"
#include "jpeg/jpeg.h"

namespace pac::jpeg {

enum class Wanted : uint8_t {
  rows,    // of pixels
  planes,  // the samples of each component
  levels,  // quantized coefficients: neither scaled nor cropped
};

struct DecodeRequest {
  Limits limits;
  int scale = 1;             // 1, 2, 4 or 8
  std::optional<Crop> crop;  // of the scaled picture; empty: all of it
  bool makes_image = true;   // 3 bytes a pixel of output count against the limits
  Wanted wanted = Wanted::rows;
  const TableState* tables = nullptr;  // from earlier files of a stream; must outlive open()
};

// bad_argument: threads or scale.
Result<void> check_options(const DecodeOptions& options);
DecodeRequest request_of(const DecodeOptions& options);
// The best ones where that instruction set is not built.
const Kernels& kernels_of(Isa isa);

}  // namespace pac::jpeg
