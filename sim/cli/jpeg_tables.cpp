#include "sim/cli/jpeg_tables.h"

#include <algorithm>
#include <cmath>

#include "sim/match.h"

namespace pac::cli {
namespace {

bool is_space(uint8_t byte) {
  return byte == ' ' || byte == '\t' || byte == '\r' || byte == '\n' || byte == ',';
}

// Reads the numbers of a table file.
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

jpeg::QuantTable scaled(const jpeg::QuantTable& steps, double scale_percent) {
  jpeg::QuantTable made;
  for (size_t i = 0; i < steps.size(); ++i)
    made[i] = static_cast<uint16_t>(std::clamp(std::floor((steps[i] * scale_percent + 50) / 100), 1.0, 255.0));
  return made;
}

}  // namespace

Result<TableSource> TableSource::family(sim::TableFamily family, ConstRgbView image, jpeg::Subsampling subsampling) {
  TableSource source;
  source.name_ = family == sim::TableFamily::adapted ? "adapted" : "annex-k";
  PAC_TRY(source.scaled_, sim::ScaledTables::create(image, family, subsampling));
  return source;
}

Result<TableSource> TableSource::from_text(std::span<const uint8_t> text) {
  PAC_TRY(const std::vector<uint16_t> steps, read_steps(text));
  TableSource source;
  source.name_ = "own";
  std::copy_n(steps.begin(), 64, source.fixed_.luma.begin());
  std::copy_n(steps.end() - 64, 64, source.fixed_.chroma.begin());
  return source;
}

jpeg::QuantTables TableSource::at_quality(double quality) const {
  if (scaled_) return scaled_->at_quality(quality);
  const double scale = sim::scale_from_quality(quality);
  return {scaled(fixed_.luma, scale), scaled(fixed_.chroma, scale)};
}

std::vector<double> TableSource::step_qualities() const {
  if (scaled_) return scaled_->step_qualities();
  std::vector<double> qualities;  // scales 1 % apart, from where every step is 1
  for (double scale = 0.2; scale < 30000; scale *= 1.01) qualities.push_back(sim::quality_from_scale(scale));
  return qualities;
}

}  // namespace pac::cli
