#include "mpeg1/rate_control.h"

#include <algorithm>

namespace pac::mpeg1 {
namespace {

constexpr double kTolerance = 0.12;     // of the target, that is let pass
constexpr int kMaxTries = 4;            // codings of one picture
constexpr double kReserve = 0.9;        // of the buffer that a picture may take
constexpr double kFirstFullness = 0.9;  // of the buffer before the first picture
constexpr double kAbsorb = 8;           // pictures over which a surplus or debt is spread

constexpr double kStep = 1.3;  // between the quantizers of neighboring pictures, at most: quality stays even

}  // namespace

RateControl::RateControl(int64_t bit_rate_bps, int64_t buffer_bits, int rate_milli, int group_length, int macroblocks)
    : bit_rate_(static_cast<double>(bit_rate_bps)),
      buffer_(static_cast<double>(buffer_bits)),
      per_picture_(static_cast<double>(bit_rate_bps) * 1000 / rate_milli),
      group_length_(group_length),
      fullness_(kFirstFullness * static_cast<double>(buffer_bits)),
      // Ordinary pictures at quantizer_scale 4: some 300 and 80 bits a macroblock.
      complexity_i_(1200.0 * macroblocks),
      complexity_p_(320.0 * macroblocks) {}

void RateControl::start_group(double finer_i, double finer_p) {
  group_finer_i_ = finer_i;
  group_finer_p_ = finer_p;
}

// A group of N pictures may have N times the rate: as many bits an I picture for each of a P picture as their
// complexities say, and how fine they are to be.
double RateControl::share() const {
  const double ratio = std::clamp(complexity_i_ / complexity_p_, 1.0, 30.0) * group_finer_i_ / group_finer_p_;
  const double of_p = per_picture_ * group_length_ / (ratio + group_length_ - 1);
  return type_ == PictureType::I ? of_p * ratio : of_p * finer_ / group_finer_p_;
}

double RateControl::usual_quantizer() const {
  const double of_group = complexity_i_ + complexity_p_ * (group_length_ - 1);
  return std::clamp(of_group / (per_picture_ * group_length_), 1.0, 31.0);
}

void RateControl::start_picture(PictureType type, double finer) {
  type_ = type;
  finer_ = finer;
  target_ = share();
  target_ += surplus_ / kAbsorb * (type == PictureType::I ? 2 : 1);
  least_ = last_quantizer_ > 0 ? std::max(1.0, last_quantizer_ / kStep) : 1;
  most_ = last_quantizer_ > 0 ? std::min(31.0, last_quantizer_ * kStep) : 31;
  // The buffer: no more than is in it, no less than what keeps it from overflowing.
  target_ = std::max(target_, fullness_ + per_picture_ - 0.98 * buffer_);
  target_ = std::clamp(target_, per_picture_ * 0.1, std::max(kReserve * fullness_, per_picture_ * 0.1));
}

double RateControl::first_quantizer() const {
  return std::clamp(complexity() * finer_ / target_, least_, most_);
}

double RateControl::next_quantizer(double quantizer, int64_t bits, int tries) const {
  const auto size = static_cast<double>(bits);
  const bool fits = size <= fullness_;
  const bool is_small = size<target_*(1 - kTolerance), is_large = size> target_ * (1 + kTolerance);
  const bool near = (!is_small || quantizer <= least_) && (!is_large || quantizer >= most_);
  if (fits && (near || tries >= kMaxTries)) return 0;
  if (quantizer >= 31 || tries >= kMaxTries + 6) return 0;
  double next = std::clamp(quantizer * size / target_, least_, most_);
  if (!fits) next = std::min(31.0, std::max(next, quantizer * 1.3));  // evenness yields to the buffer
  return next == quantizer ? 0 : next;
}

int64_t RateControl::stuffing_bits(int64_t picture_bits) const {
  const double after = fullness_ - static_cast<double>(picture_bits) + per_picture_;
  if (after <= buffer_) return 0;
  return (static_cast<int64_t>(after - buffer_) + 8) / 8 * 8;
}

int RateControl::vbv_delay(int64_t header_bits) const {
  const double ticks = 90000.0 * (fullness_ - static_cast<double>(header_bits)) / bit_rate_;
  return static_cast<int>(std::clamp(ticks, 0.0, 65534.0));
}

void RateControl::finish_picture(double quantizer, int64_t bits, int64_t bits_with_stuffing) {
  const auto size = static_cast<double>(bits);
  double& learned = type_ == PictureType::I ? complexity_i_ : complexity_p_;
  if (quantizer > 0) learned = std::max(size * quantizer / finer_, 1.0);
  if (quantizer > 0) last_quantizer_ = quantizer;
  surplus_ += share() - size;
  surplus_ = std::clamp(surplus_, -buffer_, buffer_);
  fullness_ = fullness_ - static_cast<double>(bits_with_stuffing) + per_picture_;
}

}  // namespace pac::mpeg1
