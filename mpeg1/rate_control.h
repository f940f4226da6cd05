// Constant bit rate: how many bits a picture may have, what quantizer that takes, and the decoder's buffer
// [11172-2 Annex C; the budget of a group as in Test Model 5].
#pragma once

#include <cstdint>

#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

class RateControl {
 public:
  // bit_rate in bits a second, buffer in bits; rate_milli: pictures in 1000 seconds.
  RateControl() = default;
  RateControl(int64_t bit_rate_bps, int64_t buffer_bits, int rate_milli, int group_length, int macroblocks);

  // What quantizers are divided by from now on, on average, of I and of P pictures: where some pictures of a group are
  // to be finer than others, they have the more bits.
  void start_group(double finer_i, double finer_p);
  // Of P pictures, as things stand.
  double usual_quantizer() const;
  // Before a picture, whose quantizers are divided by `finer`.
  void start_picture(PictureType type, double finer);
  // The quantizer, before that division, to try first, 1..31.
  double first_quantizer() const;
  // A picture of that many bits came of that quantizer: 0 if it will do, else the quantizer to try next. A picture
  // that will never fit is accepted at 31.
  double next_quantizer(double quantizer, int64_t bits, int tries) const;

  // Bits of zeros to append after the picture so that the buffer does not overflow, whole bytes.
  int64_t stuffing_bits(int64_t picture_bits) const;
  // 90 kHz ticks that the picture's start waits in the buffer, after `header_bits` of sequence and group headers.
  int vbv_delay(int64_t header_bits) const;
  // The picture is done: everything of it, headers and stuffing included. quantizer: before the division, 0: nothing to
  // learn from it.
  void finish_picture(double quantizer, int64_t bits, int64_t bits_with_stuffing);

 private:
  double complexity() const { return type_ == PictureType::I ? complexity_i_ : complexity_p_; }
  double share() const;  // of the picture in its group's bits

  double bit_rate_ = 0, buffer_ = 0, per_picture_ = 0;
  int group_length_ = 1;
  double fullness_ = 0;                         // of the decoder's buffer when the next picture leaves it
  double surplus_ = 0;                          // bits that pictures so far left over
  double complexity_i_ = 0, complexity_p_ = 0;  // bits times quantizer
  PictureType type_ = PictureType::I;
  double finer_ = 1, group_finer_i_ = 1, group_finer_p_ = 1;
  double target_ = 0;
  double least_ = 1, most_ = 31;  // quantizers of this picture
  double last_quantizer_ = 0;     // of the picture before, 0: none
};

}  // namespace pac::mpeg1
