// A model from a file as an experiment: lights and a camera where it has none, and a coarse model made from the fine
// one.
#pragma once

#include "raster/scene.h"
#include "sim/scenes.h"

namespace pac::sim {

// Wraps a loaded scene: width x height 512x512, split "texture" where any material is textured, else "shading". A scene
// without lights gets two directional ones (key and fill) so that lit materials have shape.
SceneSet scene_set_from(raster::Scene scene);

// The camera for frame `frame` of a turn around the model (raster/fit_camera.h); frame 0 is the still.
raster::Camera fit_camera(const raster::Scene& scene, int frame, float aspect);

// Fills scene.coarse by vertex clustering [Rossignac and Borrel 1993]: vertices in the same cell of a cubic grid of
// `cells` (2..1024) along the longest side of the bounding box become their mean; polygons that keep fewer than
// three distinct corners vanish. Objects, whose ranges of vertices must be disjoint, keep vertices of their own. False
// (coarse left empty) where nothing would remain or nothing was saved.
bool add_coarse_model(SceneSet& scene, int cells = 24);

}  // namespace pac::sim
