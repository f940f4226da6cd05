#include "sim/bit_rate.h"

#include <algorithm>
#include <cmath>

#include "base/exact_math.h"
#include "mpeg1/mpeg1.h"

namespace pac::sim {

namespace {

// A key picture may fill this share of the bucket; what it leaves is a few frames' reserve.
constexpr double kFirstShare = 0.85;
constexpr double kMostOverMean = 2;

// Bytes over quantizer_scale, where only one point is known.
constexpr double kPower = 1.2;

}  // namespace

// 11 bytes and at most 88 of the camera; the byte before the picture, its headers, and 11 bits for every 33 macroblocks
// that are skipped [11172-2 2.4.3.6, macroblock_escape].
double least_frame_bytes(int width, int height) {
  return 121 + static_cast<double>(mpeg1::macroblock_columns(width)) * mpeg1::macroblock_rows(height) / 24;
}

const char* problem_with(const BitRate& rate, int width, int height) {
  if (!rate.is_on()) return nullptr;
  if (rate.frames_per_second < 1 || rate.frames_per_second > 60) return "frames a second must be 1..60";
  if (!(rate.buffer_seconds >= 0.1 && rate.buffer_seconds <= 60)) return "the buffer must hold 0.1..60 seconds";
  if (rate.bytes_per_frame() < least_frame_bytes(width, height)) return "the bit rate is too low to repeat pictures";
  if (rate.bytes_per_frame() > rate.buffer_seconds * static_cast<double>(rate.bits_per_second) / 16)
    return "the buffer must hold two frames";
  return nullptr;
}

LeakyBucket::LeakyBucket(const BitRate& rate)
    : per_frame_(rate.bytes_per_frame()),
      capacity_(rate.buffer_seconds * static_cast<double>(rate.bits_per_second) / 8),
      frames_per_second_(rate.frames_per_second) {}

double LeakyBucket::after_leaking() const {
  return is_first_ ? 0 : std::max(0.0, full_ - per_frame_);
}

// A bucket that holds little delays little: within a second it goes back to two frames' bytes.
LeakyBucket::Goal LeakyBucket::next() const {
  const double full = after_leaking(), room = std::floor(capacity_ - full);
  if (is_first_) return {kFirstShare * room, room};
  const double most = std::min(std::floor(kMostOverMean * per_frame_), room);
  const double usual = std::min(2 * per_frame_, capacity_ / 4);
  const double wanted = per_frame_ + (usual - full) / frames_per_second_;
  return {std::clamp(wanted, 0.2 * per_frame_, 0.95 * most), most};
}

void LeakyBucket::add(uint64_t packet_bytes) {
  full_ = after_leaking() + static_cast<double>(packet_bytes);
  fullest_ = std::max(fullest_, full_);
  is_first_ = false;
}

double QuantizerSearch::settle(double scale) {
  is_settled_ = true;
  if (best_ > 0) return best_ == scale ? 0 : best_;
  return mpeg1::kSkipEverything;
}

double QuantizerSearch::guess(double scale, double bytes) const {
  const double aim = 0.95 * goal_.wanted;
  double power = kPower;
  if (low_ > 0 && high_ > low_) power = std::max(0.1, exact_log(low_bytes_ / high_bytes_) / exact_log(high_ / low_));
  const double next = scale * exact_exp(exact_log(bytes / aim) / power);
  if (low_ > 0 && high_ > 0) return std::clamp(next, low_ + 0.1 * (high_ - low_), high_ - 0.1 * (high_ - low_));
  return std::clamp(next, std::max(1.0, scale / 4), std::min(31.0, scale * 4));
}

double QuantizerSearch::next(double scale, uint64_t size_bytes) {
  if (is_settled_) return 0;
  const double bytes = static_cast<double>(size_bytes + overhead_);
  const bool is_nearer =
      best_ == 0 || std::fabs(exact_log(bytes / goal_.wanted)) < std::fabs(exact_log(best_bytes_ / goal_.wanted));
  if (bytes <= goal_.most && is_nearer) {
    best_ = scale;
    best_bytes_ = bytes;
  }
  const bool fits = bytes <= std::min(goal_.most, 1.05 * goal_.wanted);
  if (fits && (bytes >= 0.8 * goal_.wanted || scale <= 1)) return settle(scale);
  if (!fits && scale >= 31) return settle(scale);
  if (++codings_ == kMostCodings) return settle(scale);
  if (bytes <= goal_.wanted) {
    high_ = scale;
    high_bytes_ = bytes;
  } else {
    low_ = scale;
    low_bytes_ = bytes;
  }
  if (codings_ == kMostCodings - 1 && best_ == 0) return 31;  // the last chance before nothing is coded at all
  return guess(scale, bytes);
}

}  // namespace pac::sim
