// A constant bit rate for assisted video: a leaky bucket, and the quantizer of each picture so that it never overflows.
//
//   packet -> bucket (bit_rate x buffer_seconds) -> line (bit_rate) -> client
// Everything that is sent frame by frame goes through the bucket: whole packets with camera, hash and checksums. The
// session message with the resident model goes before the first frame; it takes startup_seconds() of the line.
#pragma once

#include <cstdint>

namespace pac::sim {

struct BitRate {
  uint64_t bits_per_second = 0;  // 0: no control; else at least least_frame_bytes() a frame
  int frames_per_second = 20;    // 1..60
  double buffer_seconds = 1;     // that a full bucket takes to run dry, 0.1..60

  bool is_on() const { return bits_per_second > 0; }
  double bytes_per_frame() const {
    return static_cast<double>(bits_per_second) / 8 / static_cast<double>(frames_per_second);
  }
  double startup_seconds(uint64_t session_bytes) const {
    return 8 * static_cast<double>(session_bytes) / static_cast<double>(bits_per_second);
  }
};

// A short packet with any camera, and in it a picture of skipped macroblocks: at every rate that is allowed the bucket
// has room for it, so that it never overflows.
double least_frame_bytes(int width, int height);

// Null, or what is wrong. Sizes in pixels.
const char* problem_with(const BitRate& rate, int width, int height);

// One packet a frame.
class LeakyBucket {
 public:
  explicit LeakyBucket(const BitRate& rate);

  // Bytes of the next packet. The first may fill most of the bucket; no other takes more than twice the mean.
  struct Goal {
    double wanted = 0, most = 0;
  };
  Goal next() const;

  // The frame's packet goes in; since the one before a frame's time ran out.
  void add(uint64_t packet_bytes);

  double capacity_bytes() const { return capacity_; }
  double fullest_bytes() const { return fullest_; }  // that it ever was

 private:
  double after_leaking() const;

  double per_frame_, capacity_, frames_per_second_;
  double full_ = 0, fullest_ = 0;
  bool is_first_ = true;
};

// The quantizer_scale of one picture, by coding it up to kMostCodings times.
class QuantizerSearch {
 public:
  // overhead_bytes: of the packet beside the picture.
  QuantizerSearch(const LeakyBucket::Goal& goal, uint64_t overhead_bytes) : goal_(goal), overhead_(overhead_bytes) {}

  // As mpeg1::PictureOptions::code_again. Equal on every machine.
  double next(double scale, uint64_t size_bytes);
  static double code_again(void* search, double scale, uint64_t size_bytes) {
    return static_cast<QuantizerSearch*>(search)->next(scale, size_bytes);
  }

  static constexpr int kMostCodings = 6;

 private:
  double settle(double scale);
  double guess(double scale, double bytes) const;

  LeakyBucket::Goal goal_;
  uint64_t overhead_;
  int codings_ = 0;
  bool is_settled_ = false;
  double low_ = 0, low_bytes_ = 0, high_ = 0, high_bytes_ = 0;  // bracket: more and no more than wanted; 0: not yet
  double best_ = 0, best_bytes_ = 0;                            // nearest to wanted of those that fit; 0: none
};

}  // namespace pac::sim
