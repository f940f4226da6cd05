// The two kinds of input of `pac metrics`.
#pragma once

#include <string>

#include "sim/cli/command.h"

namespace pac::cli {

struct NamedBytes {
  std::string path;
  Bytes bytes;
};

bool is_y4m(std::span<const uint8_t> bytes);

// Scores and prints two Y4M sequences of equal size and length. kDone, or kBadData after the message.
int compare_sequences(const Options& options, const NamedBytes& reference, const NamedBytes& test);

}  // namespace pac::cli
