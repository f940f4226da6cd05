// The quantizers of a picture's macroblocks, and what a bit may cost in distortion.
#include <algorithm>
#include <cmath>

#include "base/kernels/block_kernels.h"
#include "mpeg1/encoder_state.h"
#include "mpeg1/trellis.h"

namespace pac::mpeg1 {
namespace {

// What a bit may cost in squared error, over quantizer_scale squared. At high rate 6 dB a bit and a uniform error of a
// step (2 quantizer_scale) give 0.46; blocks of few levels want more.
constexpr double kLambda = 0.85;

// I pictures: what quantizer_scale is multiplied by where the macroblock moves and where it stays, how much of it is
// expected to stay before anything was seen, and what lambda is multiplied by.
constexpr double kMovingIntraScale = 0.85, kStillIntraScale = 0.7, kUnknownStillness = 0.3, kIntraLambda = 0.8;

double mix(double a, double b, double share) {
  return a + (b - a) * share;
}

// Without changes that are not worth their bits: `before` stays while it is near what is wanted.
int keep_or_change(int before, double wanted) {
  constexpr double kLeastChange = 0.7, kLeastShare = 0.12;
  const int rounded = std::clamp(static_cast<int>(std::floor(wanted + 0.5)), 1, 31);
  return before != 0 && std::abs(wanted - before) < std::max(kLeastChange, kLeastShare * wanted) ? before : rounded;
}

}  // namespace

void Encoder::State::make_lambdas() {
  double mean = 0;  // of the matrix, where most levels are
  for (size_t k = 1; k < 16; ++k) mean += sequence.non_intra_matrix[kNaturalFromZigzag[k]] / 15.0;
  lambda_of_one = kDistortionScale * kLambda * (mean / 16) * (mean / 16);
  for (int q = 1; q < 32; ++q) {
    const double step = q * mean / 16;
    const double of_p = kDistortionScale * kLambda * step * step;
    lambda[0][q] = std::max<int64_t>(1, static_cast<int64_t>(of_p));
    lambda[1][q] = std::max<int64_t>(1, static_cast<int64_t>(of_p * mix(1, kIntraLambda, reuse())));
  }
}

// How much of an I picture's quality the pictures after it inherit, 0..1: as measured with groups of 15.
double Encoder::State::reuse() const {
  return std::min(1.0, (options.gop_length - 1) / 14.0);
}

// What quantizer_scale is multiplied by in I pictures. The pictures after them repeat their quality and their errors,
// so that a bit there is worth more, the more so the longer the macroblock stays as it is.
double Encoder::State::intra_scale(size_t macroblock) const {
  const double stillness = n_watched > 0 ? static_cast<double>(still[macroblock]) / n_watched : kUnknownStillness;
  return mix(1, mix(kMovingIntraScale, kStillIntraScale, stillness), reuse());
}

// Between integers, settled macroblock by macroblock.
double Encoder::State::set_wanted(PictureType type, const float* scales, double scale) {
  const auto count = quantizers.size();
  wanted.resize(count);
  lambdas.resize(count);
  const double share = type == PictureType::I ? mix(1, kIntraLambda, reuse()) : 1;
  double sum = 0;
  for (size_t i = 0; i < count; ++i) {
    const double q = std::max(1.0, scale * scales[i]);
    wanted[i] = static_cast<float>(q);
    lambdas[i] = std::max<int64_t>(1, static_cast<int64_t>(lambda_of_one * share * q * q));
    sum += q;
  }
  return sum / static_cast<double>(count);
}

// Between integers the first part of the macroblocks has the smaller quantizer: few changes of it in the stream.
double Encoder::State::set_quantizers(PictureType type, const PictureOptions& picture, double scale) {
  const bool is_free = !has_rate && picture.quantizer_scale == 0;
  const float* scales = !picture.quantizer_factors.empty() ? picture.quantizer_factors.data()
                        : picture.quantizer_scale == 0 && picture.quantizer_map.empty()
                            ? lookahead.scales(frame_in_group)
                            : nullptr;
  if (scales != nullptr) {
    const double mean = set_wanted(type, scales, scale);
    if (picture.quantizer_factors.empty()) return mean;
    const auto step = 1 / static_cast<float>(wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i) wanted[i] += (static_cast<float>(i) + 0.5F) * step - 0.5F;
    return scale;
  }
  wanted.clear();
  const bool is_even = picture.quantizer_map.empty() && (type == PictureType::P || !is_free);
  if (is_even && scale == std::floor(scale)) {
    std::fill(quantizers.begin(), quantizers.end(), static_cast<uint8_t>(std::clamp(scale, 1.0, 31.0)));
    return scale;
  }
  double sum = 0;
  int before = 0;
  for (size_t i = 0; i < quantizers.size(); ++i) {
    const double scaled = type == PictureType::I && is_free ? scale * intra_scale(i) : scale;
    const double position = (static_cast<double>(i) + 0.5) / static_cast<double>(quantizers.size());
    before = is_free && type == PictureType::I ? keep_or_change(before, scaled + position - 0.5)
                                               : std::clamp(static_cast<int>(std::floor(scaled + position)), 1, 31);
    quantizers[i] = static_cast<uint8_t>(before);
    if (!picture.quantizer_map.empty()) quantizers[i] = picture.quantizer_map[i];
    sum += quantizers[i];
  }
  return is_even ? scale : sum / static_cast<double>(quantizers.size());
}

void Encoder::State::watch_stillness(PictureType type) {
  if (type == PictureType::I) {
    std::fill(still.begin(), still.end(), uint8_t{0});
    n_watched = 0;
    return;
  }
  ++n_watched;
  for (size_t i = 0; i < still.size(); ++i)
    if (macroblocks[i].kind != MacroblockKind::intra && macroblocks[i].pattern == 0) ++still[i];
}

}  // namespace pac::mpeg1
