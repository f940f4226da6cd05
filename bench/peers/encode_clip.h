// A clip through our MPEG-1 encoder.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "bench/peers/y4m_clip.h"
#include "mpeg1/mpeg1.h"

namespace pac::bench {

// Appends the stream of the clip, whose first frame gives its size, and returns the seconds by `clock` after the
// encoder is made, or 0 where it fails. looks_ahead: the encoder knows the frames that follow, to the end of a group.
template <class Clock>
double encode_clip(const Clip& clip, mpeg1::SequenceOptions options, bool looks_ahead, Clock&& clock,
                   std::vector<uint8_t>& bytes) {
  options.width = clip[0].width();
  options.height = clip[0].height();
  auto encoder = mpeg1::Encoder::create(options);
  if (!encoder.ok()) return 0;
  const double start = clock();
  for (size_t i = 0; i < clip.size(); ++i) {
    mpeg1::PictureOptions picture;
    std::vector<const Frame420*> following;
    const size_t end = std::min(clip.size(), i + static_cast<size_t>(options.gop_length));
    for (size_t k = i + 1; looks_ahead && k < end; ++k) following.push_back(&clip[k]);
    picture.following = following;
    if (!encoder->add(clip[i], bytes, picture).ok()) return 0;
  }
  encoder->finish(bytes);
  return clock() - start;
}

}  // namespace pac::bench
