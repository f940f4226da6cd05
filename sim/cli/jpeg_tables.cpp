#include "sim/cli/jpeg_tables.h"

#include <algorithm>
#include <vector>

#include "jpeg/tables.h"

namespace pac::cli {
namespace {

bool is_space(uint8_t byte) {
  return byte == ' ' || byte == '\t' || byte == '\r' || byte == '\n' || byte == ',';
}

Result<std::vector<uint16_t>> read_steps(std::span<const uint8_t> text) {
  std::vector<uint16_t> steps;
  for (size_t at = 0; at < text.size();) {
    if (is_space(text[at])) {
      ++at;
    } else if (text[at] == '#') {
      while (at < text.size() && text[at] != '\n') ++at;
    } else {
      const size_t start = at;
      unsigned step = 0;
      for (; at < text.size() && text[at] >= '0' && text[at] <= '9' && step < 1000; ++at)
        step = 10 * step + (text[at] - unsigned{'0'});
      const bool ends = at == text.size() || is_space(text[at]) || text[at] == '#';
      if (at == start || !ends || step < 1 || step > 255)
        return Failure{Error::corrupt, start, "not a whole number in 1..255"};
      steps.push_back(static_cast<uint16_t>(step));
    }
  }
  if (steps.size() != 64 && steps.size() != 128)
    return Failure{Error::corrupt, text.size(), "holds neither 64 nor 128 numbers"};
  return steps;
}

}  // namespace

Result<jpeg::QuantTables> read_tables(std::span<const uint8_t> text) {
  PAC_TRY(const std::vector<uint16_t> steps, read_steps(text));
  jpeg::QuantTables tables;
  std::copy_n(steps.begin(), 64, tables.luma.begin());
  std::copy_n(steps.end() - 64, 64, tables.chroma.begin());
  return tables;
}

jpeg::QuantTables scale_tables(const jpeg::QuantTables& tables, double quality) {
  return jpeg::scaled_tables(jpeg::reference_of(tables), quality);
}

}  // namespace pac::cli
