// A scene that can do every split and takes no time to build: a textured floor and wall with baked colors, a lit
// textured box, and a ball with a fine and a coarse model.
#pragma once

#include "raster/scene.h"
#include "sim/scenes.h"

namespace pac::test {

// lit = false bakes all colors (so that `lighting` is possible); true adds materials that lights shine on.
sim::SceneSet small_scene(bool lit);

// Looks at it; `frame` moves the eye.
raster::Camera small_camera(int frame, float aspect);

}  // namespace pac::test
