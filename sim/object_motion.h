// The objects of a model: their transforms in and out, and which of them moves each face.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "raster/scene.h"

namespace pac::sim {

// World from object of each of a scene's objects, in its order.
using Transforms = std::vector<glm::mat4>;

Transforms transforms_of(const raster::Scene& scene);

// Affine (last row 0 0 0 1) with numbers that the rasterizer takes: none beyond 2^60, no NaN.
bool is_transform(const glm::mat4& matrix);

// Same bits.
bool same_transform(const glm::mat4& a, const glm::mat4& b);

// Moves the objects; where they were become their previous transforms. Fails with bad_argument, and moves nothing:
// their number differs, or not is_transform() (Failure::byte_offset is which).
Result<void> move_objects(std::span<const glm::mat4> transforms, raster::Scene& scene);

// Fails with corrupt where an object has vertices that the mesh has not, two share a vertex, or a transform is none
// (Failure::byte_offset is the object's number).
Result<void> check_objects(const raster::Scene& scene);

// Makes an object without vertices of each light, which moves with it from then on. Behind the objects that are there.
void move_lights(raster::Scene& scene);
// Where those objects are in a frame: they go round the vertical through the origin once in kLightTurnFrames, at frame
// 0 all are the identity.
constexpr int kLightTurnFrames = 160;
void add_light_transforms(int frame, size_t n_lights, Transforms& out);

// What moves a face. kTorn: its corners move in different ways, so that no transform does.
constexpr uint32_t kStands = 0, kTorn = UINT32_MAX;

// Index = id of the rasterizer (face + 1, 0 = background): kStands, object + 1, or kTorn. Empty where there are no
// objects. `scene` passes check_objects().
std::vector<uint32_t> movers_of(const raster::Scene& scene);

}  // namespace pac::sim
