// Wavefront OBJ + MTL with PNG, JPEG and PPM textures.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/file_io.h"
#include "base/image.h"
#include "base/result.h"
#include "raster/node_animation.h"
#include "raster/scene.h"

namespace pac::raster {

// How the loader reaches the outside world; the caller decides (raster/ never includes jpeg/).
struct AssetSource {
  // The bytes of the file that a MTL or texture statement names, relative to the OBJ. Backslashes are already slashes.
  std::function<Result<Bytes>(const std::string& name)> read;
  // Decodes an image file by its content.
  std::function<Result<RgbaImage>(std::span<const uint8_t> bytes)> decode_image;
};

// Something wrong that did not stop the loading: a missing texture, an unknown statement, a degenerate face.
struct Warning {
  const char* text = "";
  std::string name;          // the file or statement it is about
  uint64_t byte_offset = 0;  // in the OBJ or MTL
};

// A camera that the file holds, as make_camera() wants it.
struct LoadedCamera {
  glm::vec3 eye{0}, target{0, 0, -1}, up{0, 1, 0};
  float fov_y_rad = 0.6f, near_plane = 0.1f, far_plane = 100;
};

struct LoadedScene {
  Scene scene;
  NodeAnimation animation;            // moves scene.objects; empty where nothing moves
  std::vector<LoadedCamera> cameras;  // in the file's order of nodes, at time 0
  std::vector<Warning> warnings;
};

// Statements v (with colors after the coordinates), vt, vn, f (all forms, negative and forward references, any number
// of corners), usemtl, mtllib, s; g and o are skipped; others are skipped with a warning. v texture coordinates are
// flipped: OBJ counts them upwards, Vertex::texcoord downwards. Missing normals are generated (rule in
// load_normals.h). Faces without a material are light gray; a material or texture that cannot be found becomes a
// magenta and white checker with a warning. Normals and texture coordinates that are not finite become 0 with a
// warning. The scene gets the light rig of fit_camera.h and uses nothing of `bytes` afterwards. Fails, byte_offset
// being the first byte of the offending line (after joining continued ones), with
// - corrupt: "malformed number", "malformed index", "number is not finite", "index 0: indices start at 1", "index out
// of
//   range", "vertex with fewer than three coordinates", "normal with fewer than three numbers", "texture coordinate
//   without a number";
// - unsupported: UTF-16 text; no faces (empty file, point clouds, lines);
// - limit_exceeded: the file is longer than limits.max_bytes, more than limits.max_triangles.
Result<LoadedScene> load_obj(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits = {});

}  // namespace pac::raster
