// What is drawn: meshes with materials, textures and lights, and the camera that looks at them.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"

namespace pac::raster {

enum class Wrap : uint8_t { repeat, clamp };
enum class Filter : uint8_t { nearest, bilinear, trilinear };

// A texture image (RGBA, sRGB-encoded) with its mip chain: level 0 as loaded, each next one half as large (rounded
// down, at least 1), down to 1x1. The 1x1 level is the texture's mean color: it replaces the texture where texturing is
// off.
struct Texture {
  std::string name;
  std::vector<RgbaImage> levels;
};

// How a surface looks. All colors are display-referred (sRGB-encoded) in [0, 1]; see raster/README.md.
struct Material {
  std::string name;
  glm::vec3 ambient{0.2f};
  glm::vec3 diffuse{0.8f};
  glm::vec3 specular{0.0f};
  int shininess = 1;  // exponent of the specular lobe, 1..1000
  glm::vec3 emission{0.0f};
  int32_t texture = -1;  // index into Scene::textures; -1 = none
  Wrap wrap = Wrap::repeat;
  Filter filter = Filter::trilinear;
  bool lit = true;        // false: vertex colors are final (radiosity, dicing) and `lights` are ignored
  bool two_sided = true;  // false: back faces are not drawn
};

struct Light {
  enum class Kind : uint8_t { directional, point } kind = Kind::directional;
  glm::vec3 direction{0, 0, -1};  // directional: the way the light travels, unit length
  glm::vec3 position{0};          // point
  glm::vec3 color{1};             // no attenuation with distance unless range > 0
  float range = 0;                // point: intensity 1 / (1 + (distance / range)^2); 0 = constant
};

struct Scene {
  std::string name;
  Mesh mesh;
  std::vector<Material> materials;  // at least one if the mesh has faces
  std::vector<Texture> textures;
  std::vector<Light> lights;
  glm::vec3 ambient_light{1.0f};
  glm::vec3 background{0.0f};
};

// Where from and how the scene is seen. Travels between machines as the raw bits of these floats, never as angles.
struct Camera {
  glm::mat4 clip_from_world{1.0f};  // OpenGL clip space: x, y in [-w, w], z in [-w (near), w (far)]
  glm::vec3 eye{0.0f};              // world position, for specular lighting
};

// Right-handed look-at and perspective, by exact_math: same bits on every machine. fov is vertical; aspect =
// width/height.
Camera make_camera(glm::vec3 eye, glm::vec3 target, glm::vec3 up, float fov_y_rad, float aspect, float near_plane,
                   float far_plane);

// Box-filters level 0 down to 1x1. `image` must not be empty.
Texture make_texture(std::string name, RgbaImage image);

}  // namespace pac::raster
