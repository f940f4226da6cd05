// Object transforms: where the vertices of a scene are in this frame, and where they were on the screen in the last
// one.
#pragma once

#include <vector>

#include "base/parallel.h"
#include "raster/scene.h"

namespace pac::raster {

// The scene's mesh in world space: `out` is a copy with the vertices of each object moved and their normals turned by
// the inverse transpose (not normalized again). Later objects apply to what earlier ones made of a vertex. Fails with
// corrupt where an object's vertices are not in the mesh or a matrix is not finite; Failure::byte_offset is its number.
Result<void> pose_mesh(const Scene& scene, Mesh& out);

// Clip coordinates of every vertex under the previous camera and the objects' previous transforms, four a vertex; w <=
// 0 for what is not finite.
void previous_clip_positions(const Scene& scene, const Camera& previous_camera, ThreadPool& pool,
                             std::vector<float>& out);

}  // namespace pac::raster
