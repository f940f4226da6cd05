// FLIP: how much two pictures seem to differ when they are shown in turn at the same place, per pixel. Made for
// renderings.
//
// Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for Alternating
// Images", HPG 2020; the form for pictures of 8-bit sRGB. Both pictures are blurred by the eye's contrast sensitivity
// in an opponent color space and compared in Hunt-adjusted CIELab (HyAB distance, compressed); the color difference is
// raised where edges or points appear or vanish.
//
// Range: 0 = equal ... 1 = as far apart as sRGB allows, green against blue (black against white: 0.97). The figure of a
// picture is the mean of its map.
#pragma once

#include "base/image.h"

namespace pac {

class ThreadPool;

// Pixels per degree of visual angle: a 0.7 m wide screen of 3840 pixels seen from 0.7 m, the authors' default.
constexpr double kFlipPixelsPerDegree = 67.0206432;

// The error of each pixel, 0..1. Pictures of equal, nonzero size (else PAC_ASSERT). Same bits on every system and for
// every number of threads; no pool = on the caller's thread. Memory: about 100 bytes a pixel while it runs.
DepthImage flip_map(ConstRgbView reference, ConstRgbView test, ThreadPool* pool = nullptr);

// The mean of a map; of the map of two pictures.
double flip_mean(const DepthImage& map);
double flip(ConstRgbView reference, ConstRgbView test, ThreadPool* pool = nullptr);

// A map of errors in 0..1 in the colors magma: black, purple, orange, light yellow.
RgbImage magma_picture(const DepthImage& map);

}  // namespace pac
