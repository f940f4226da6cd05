// The transmitted model [Levoy95 s.3]: per frame, polygons clipped to the view, in window coordinates of two bytes
// each, with lit colors: ten bytes a vertex before geomcodec codes them with their connectivity.
//
// The client draws the decoded vertices as they are: x, y in pixels and window depth z are affine on the screen
// across a plane polygon (z = a + b/w), so an affine matrix takes them to clip space with w = 1, and colors are
// interpolated linearly on the screen, as a low-end workstation of 1995 did. The server draws its L from the
// same decoded vertices by the same calls, so rounding costs difference bytes, never a mismatch.
#pragma once

#include <cstdint>
#include <span>

#include "base/file_io.h"
#include "base/result.h"
#include "geomcodec/geomcodec.h"
#include "raster/renderer.h"
#include "raster/scene.h"

namespace pac::sim {

struct ScreenModel {
  Bytes bytes;                   // geomcodec's stream: everything the client needs for this frame's L
  geomcodec::EncodedSize parts;  // the same bytes by what they hold
  uint64_t polygons = 0;         // that survive clipping
  uint64_t vertices = 0;
};

// Clips `scene` against the six planes of the view, lights its vertices (Gouraud, untextured: mean colors), quantizes
// to position_bits (1..16) a coordinate and encodes. The scene is one that low_scene made. Fails as geomcodec::encode
// and Renderer::render; bad_argument for other position_bits.
Result<ScreenModel> encode_screen_model(const raster::Scene& scene, const raster::Camera& camera,
                                        const raster::RenderQuality& quality, int width, int height,
                                        int position_bits = 16);

// Decodes such a stream and draws it: L as both sides see it. `low` has the renderer's size. Fails as
// geomcodec::decode; corrupt where a face names a material other than 0.
Result<void> draw_screen_model(raster::Renderer& renderer, std::span<const uint8_t> bytes,
                               const raster::RenderQuality& quality, glm::vec3 background, RgbView low,
                               const Limits& limits = {});

}  // namespace pac::sim
