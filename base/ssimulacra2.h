// SSIMULACRA 2.1: how visible the damage of compression is, the project's first metric for stills and frames.
//
// Jon Sneyers, Cloudinary, 2022-2023 (https://github.com/cloudinary/ssimulacra2; no paper). Both pictures go to XYB
// (the color space of JPEG XL: cube roots of cone responses, as red-green, luma, blue) at six scales, each half of the
// one before in linear light. Per scale and channel three error maps are pooled by a 1-norm (mean) and a 4-norm: SSIM
// without the denominator of its luminance term; edges that only the test has (ringing, blocks, bands); edges that only
// the reference has (blur). A weighted sum of these 108 figures and a fitted curve give the score. The weights are
// published data, tuned on people's votes (CID22, TID2013, KADID-10k, KonFiG-IQA).
//
// Range: 100 = equal, 90 = not told apart in a flicker test, 70 = high quality (about libjpeg-turbo quality 70 4:2:0),
// 50 = medium (quality 35), 30 = low (quality 20), 10 = very low (quality 14); any negative value = extreme damage.
#pragma once

#include <vector>

#include "base/image.h"

namespace pac {

class ThreadPool;

// A reference picture prepared once for any number of tests against it: searches save nearly half of the time.
// Distinct objects are independent; score() changes nothing in the object.
class Ssimulacra2 {
 public:
  // sRGB, nonempty (else PAC_ASSERT). Nothing of `reference` is kept. Sides below 8 pixels, where the metric is not
  // defined, are extended to 8 by repeating the last column or row, in the tests too. Memory: 16 bytes a pixel.
  explicit Ssimulacra2(ConstRgbView reference);

  // `test` has the reference's size (else PAC_ASSERT). Same bits on every system and for every number of threads; no
  // pool = on the caller's thread.
  double score(ConstRgbView test, ThreadPool* pool = nullptr) const;

  // The three channels of one scale: X, Y, B - Y, each shifted and scaled into about 0..1.
  struct Xyb {
    Image<float, 1> channel[3];
  };

 private:
  int width_ = 0, height_ = 0;
  std::vector<Xyb> scales_;
};

// One pair.
double ssimulacra2(ConstRgbView reference, ConstRgbView test, ThreadPool* pool = nullptr);

}  // namespace pac
