// CAMBI: how visible the bands are in what should be smooth, without a reference. The number for Levoy's first reason
// for polygons: smooth shading without contours.
//
// Tandon et al., "CAMBI: Contrast-aware Multiscale Banding Index", PCS 2021, with the constants of Netflix's libvmaf,
// whose figures this reproduces. In flat surroundings, at five scales, the share of pixels in a window that lie 1 to 4
// ten-bit levels away from the middle one, where such a step is above the threshold of visibility; pooled over the
// worst 60 % of pixels.
#pragma once

#include "base/image.h"

namespace pac {

enum class LumaRange : uint8_t { full, limited };  // 0..255, or 16..235 as in television

// 0 = no bands; libvmaf's authors call 5 and more annoying. Nonempty (else PAC_ASSERT). Made for pictures of 216 pixels
// a side and more: smaller ones get a number, but its scale means less. libvmaf takes every picture for limited range.
// Compare a test with its reference: texture and dithering also count a little.
double cambi(PlaneView<const uint8_t> luma, LumaRange range = LumaRange::full);
double cambi_luma(ConstRgbView image);  // of luma_bt601

}  // namespace pac
