// What is drawn: meshes with materials, textures and lights, and the camera that looks at them.
#pragma once

#include <array>
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

// How opaque a surface is: texel's alpha * vertex's alpha * Material::opacity, where the material asks.
enum class AlphaMode : uint8_t {
  opaque,  // alpha is ignored
  mask,    // a sample is covered where alpha is at least the cutoff, by the texture even where texturing is off
  blend,   // drawn over the opaque picture in the order of the scene's faces, hidden by what is nearer, hiding nothing
};

// A texture image (RGBA, sRGB-encoded; alpha as Material::alpha says) with its mip chain: level 0 as loaded, each next
// one half as large (rounded down, at least 1), box-filtered, down to 1x1. The 1x1 level is the texture's mean color:
// it replaces the texture where texturing is off. Made by make_texture().
struct Texture {
  struct Level {
    int width = 0, height = 0;
    int pitch = 0;      // width + 1: each row ends with a copy of its first texel, so that a pair is one load
    size_t offset = 0;  // of the first texel
  };
  std::string name;
  std::vector<Level> levels;
  std::vector<uint8_t> texels;  // 4 bytes each, all levels

  bool empty() const { return levels.empty(); }
  int width() const { return empty() ? 0 : levels[0].width; }
  int height() const { return empty() ? 0 : levels[0].height; }
  // Valid as long as the texture lives unchanged.
  ConstRgbaView level(size_t i) const {
    return {texels.data() + 4 * levels[i].offset, levels[i].width, levels[i].height, ptrdiff_t{4} * levels[i].pitch};
  }
  // RGBA; mid grey for an empty texture.
  std::array<uint8_t, 4> mean_color() const {
    if (empty()) return {128, 128, 128, 255};
    const uint8_t* mean = level(levels.size() - 1).data;
    return {mean[0], mean[1], mean[2], mean[3]};
  }
};

// How a surface looks. All colors are display-referred (sRGB-encoded) in [0, 1]; see raster/README.md.
struct Material {
  std::string name;
  glm::vec3 ambient{0.2f};
  glm::vec3 diffuse{0.8f};
  glm::vec3 specular{0.0f};
  int shininess = 1;  // exponent of the specular lobe, 0..1000 (clamped)
  glm::vec3 emission{0.0f};
  int32_t texture = -1;  // index into Scene::textures; -1 = none
  Wrap wrap = Wrap::repeat;
  Filter filter = Filter::trilinear;
  bool lit = true;        // false: vertex colors are final (radiosity, dicing) and `lights` are ignored
  bool two_sided = true;  // false: back faces are not drawn where RenderQuality::cull_back_faces
  // Trilinear filter only: the most probes along the longer side of a pixel's footprint, 1..8 (clamped). 1: isotropic.
  int anisotropy = 1;
  AlphaMode alpha = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  float opacity = 1;
  // Indices into Scene::textures, -1 = none, with the material's wrap, filter and anisotropy. An empty texture counts
  // as none. Lit materials only; where texturing is off, the mean of each (a flat normal map).
  int32_t normal_texture = -1;  // (channel - 128) / 127: right, up and out of the texture; Phong shading only
  float normal_scale = 1;       // of right and up
  int32_t specular_texture = -1;
  int32_t emission_texture = -1;  // scales `emission`, which the base texture then leaves alone
  glm::vec3 reflection{0.0f};     // scales Scene::environment, seen in the surface
  float reflection_blur = 0;      // 0: as sharp as the environment, 1: its mean color
};

struct Light {
  enum class Kind : uint8_t { directional, point, spot } kind = Kind::directional;
  glm::vec3 direction{0, 0, -1};  // directional, spot: the way the light travels, any length
  glm::vec3 position{0};          // point, spot
  glm::vec3 color{1};             // no attenuation with distance unless range > 0
  float range = 0;                // point, spot: intensity 1 / (1 + (distance / range)^2); 0 = constant
  float cone_inner = 1;           // spot: cosine of the angle from the axis up to which it is full ...
  float cone_outer = 0;           // ... and of the angle from which on it is dark, linear in the cosine between
  // Under full lighting: the radius of the ball that shines (directional: tangent of the light's angular radius), which
  // makes shadows soft; and whether anything shades it at all.
  float radius = 0;
  bool casts_shadows = true;
  int32_t object = -1;  // index into Scene::objects: position and direction move with it; -1: they are the world's
};

// Vertices that move together: an affine transform (last row 0 0 0 1) from the mesh's coordinates to the world's, in
// this frame and in the previous one. Vertices of no object stand still.
struct Object {
  uint32_t first_vertex = 0, vertex_count = 0;
  glm::mat4 world_from_object{1.0f};
  glm::mat4 previous_world_from_object{1.0f};
};

// What the air adds: distances from the eye in units of the world. The background is not fogged.
struct Fog {
  enum class Kind : uint8_t {
    none,
    linear,               // nothing up to `start`, only fog from `end` on
    exponential,          // the share exp(-density * distance) of the surface's color arrives
    exponential_squared,  // exp(-(density * distance)^2)
  } kind = Kind::none;
  glm::vec3 color{0.5f};
  float start = 0, end = 1;
  float density = 0;
};

struct Scene {
  std::string name;
  Mesh mesh;
  std::vector<Object> objects;
  std::vector<Material> materials;  // at least one if the mesh has faces
  std::vector<Texture> textures;
  std::vector<Light> lights;
  glm::vec3 ambient_light{1.0f};
  // Under full lighting, surfaces within this distance shade each other from the ambient light. 0: nothing does.
  // Negative: a fifth of the diagonal of the mesh's bounding box.
  float ambient_reach = -1;
  glm::vec3 background{0.0f};
  Fog fog;
  // Index into `textures` of what reflecting materials show, -1 = nothing: longitude from left to right with -z in the
  // middle, latitude from +y at the top to -y.
  int32_t environment = -1;
};

// Where the light is in this frame. An object that the scene has not moves nothing.
Light posed_light(const Scene& scene, const Light& light);

// Where from and how the scene is seen. Travels between machines as the raw bits of these floats, never as angles.
struct Camera {
  glm::mat4 clip_from_world{1.0f};  // OpenGL clip space: x, y in [-w, w], z in [-w (near), w (far)]
  glm::vec3 eye{0.0f};              // world position, for specular lighting
};

// Right-handed look-at and perspective, by exact_math: same bits on every machine. fov is vertical, in (0, pi); aspect
// = width/height. Arguments that make no camera (eye = target, near >= far, up along the view, ...) give a singular or
// non-finite matrix, which render() refuses.
Camera make_camera(glm::vec3 eye, glm::vec3 target, glm::vec3 up, float fov_y_rad, float aspect, float near_plane,
                   float far_plane);

// Copies the image and box-filters it down to 1x1, each level from the unrounded one above it. An empty image makes an
// empty texture, which draws as mid grey.
Texture make_texture(std::string name, const RgbaImage& image);

}  // namespace pac::raster
