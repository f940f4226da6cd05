// A camera and lights for models that come without them. y is up, as in most OBJ and PLY files.
#pragma once

#include "raster/scene.h"

namespace pac::raster {

// Looks at the whole model from the right front, 20 degrees above: as near as its vertices allow with a small margin.
// aspect = width / height. A scene without faces gives a camera that looks at the origin.
Camera fit_camera(const Scene& scene, float aspect);

// One step of a turn around the model: frame 0 looks from where fit_camera() does, kOrbitFrames make a full turn, all
// at the one distance from which every frame fits.
inline constexpr int kOrbitFrames = 120;
Camera orbit_camera(const Scene& scene, float aspect, int frame);

// Replaces the scene's lights: a warm key light from above left, a cool fill light from the right, a rim light from
// behind, each with a size as soft boxes have, a quarter of ambient light; a light gray background.
void set_default_lights(Scene& scene);

}  // namespace pac::raster
