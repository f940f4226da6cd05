#include "sim/scene_builder.h"

#include "base/exact_math.h"

namespace pac::sim {

namespace {

glm::vec3 linear_color(glm::vec3 encoded) {
  return {static_cast<float>(linear_from_srgb(static_cast<double>(encoded.x))),
          static_cast<float>(linear_from_srgb(static_cast<double>(encoded.y))),
          static_cast<float>(linear_from_srgb(static_cast<double>(encoded.z)))};
}

// The mean of the texture in linear light: what the radiosity of a textured surface follows [Gershbein94].
glm::vec3 mean_reflectance(const RgbaImage& image) {
  double decoded[256];
  for (int i = 0; i < 256; ++i) decoded[i] = linear_from_srgb(i / 255.0);
  uint64_t histogram[3][256] = {};
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (int c = 0; c < 3; ++c) ++histogram[c][image.pixel(x, y)[c]];
  glm::vec3 mean;
  const double n_texels = static_cast<double>(image.width()) * static_cast<double>(image.height());
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (int i = 0; i < 256; ++i) sum += decoded[i] * static_cast<double>(histogram[c][i]);
    mean[c] = static_cast<float>(sum / n_texels);
  }
  return mean;
}

}  // namespace

std::vector<float> equal_lines(int n) {
  std::vector<float> lines;
  for (int i = 0; i <= n; ++i) lines.push_back(static_cast<float>(i) / static_cast<float>(n));
  return lines;
}

uint32_t SceneBuilder::add_color(std::string name, glm::vec3 color) {
  raster::Material material;
  material.name = std::move(name);
  material.diffuse = color;
  material.ambient = color;
  material.lit = false;
  scene_.materials.push_back(std::move(material));
  FaceOptics optics;
  optics.reflectance = linear_color(color);
  optics_.push_back(optics);
  return static_cast<uint32_t>(scene_.materials.size() - 1);
}

uint32_t SceneBuilder::add_texture(std::string name, RgbaImage image, raster::Wrap wrap) {
  const uint32_t index = add_color(name, glm::vec3(1.0f));
  optics_[index].reflectance = mean_reflectance(image);
  raster::Material& made = scene_.materials[index];
  made.texture = static_cast<int32_t>(scene_.textures.size());
  made.wrap = wrap;
  scene_.textures.push_back(raster::make_texture(std::move(name), std::move(image)));
  return index;
}

void SceneBuilder::place(glm::vec3 origin, float cosine, float sine) {
  origin_ = origin;
  cosine_ = cosine;
  sine_ = sine;
}

uint32_t SceneBuilder::add_vertex(glm::vec3 position, glm::vec3 normal, glm::vec2 texcoord) {
  const glm::vec3 p = to_world(position), n = direction(normal);
  Vertex vertex;
  for (int c = 0; c < 3; ++c) {
    vertex.position[c] = p[c];
    vertex.normal[c] = n[c];
  }
  vertex.texcoord[0] = texcoord.x;
  vertex.texcoord[1] = texcoord.y;
  scene_.mesh.vertices.push_back(vertex);
  return static_cast<uint32_t>(scene_.mesh.vertices.size() - 1);
}

void SceneBuilder::add_face(std::initializer_list<uint32_t> corners, uint32_t material) {
  Mesh& mesh = scene_.mesh;
  mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(corners.size()), material});
  mesh.indices.insert(mesh.indices.end(), corners);
}

void SceneBuilder::patch(glm::vec3 origin, glm::vec3 edge_s, glm::vec3 edge_t, int n_s, int n_t, uint32_t material,
                         const TextureWindow& window) {
  grid(origin, edge_s, edge_t, equal_lines(n_s), equal_lines(n_t), material, window, [](int, int) { return false; });
}

void SceneBuilder::box(glm::vec3 low, glm::vec3 high, uint32_t material, unsigned sides, glm::ivec3 cuts,
                       glm::vec2 repeat) {
  const glm::vec3 size = high - low;
  const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  // Each box starts elsewhere in the texture, so that neighbours do not look cut from the same board.
  const float start = static_cast<float>(face_count() % 16u) * 0.3125f;
  const auto side = [&](unsigned bit, glm::vec3 origin, glm::vec3 s, glm::vec3 t, int n_s, int n_t) {
    if ((sides & bit) == 0) return;
    const float length_s = glm::length(s), length_t = glm::length(t);
    const bool turned = length_s > length_t;
    const float across = turned ? length_t : length_s, along = turned ? length_s : length_t;
    patch(origin, s, t, n_s, n_t, material, {start, start, across / repeat.x, along / repeat.y, turned});
  };
  side(kFront, low + z, x, y, cuts.x, cuts.y);
  side(kBack, low + x, -x, y, cuts.x, cuts.y);
  side(kRight, low + x + z, -z, y, cuts.z, cuts.y);
  side(kLeft, low, z, y, cuts.z, cuts.y);
  side(kTop, low + y + z, x, -z, cuts.x, cuts.z);
  side(kBottom, low, x, z, cuts.x, cuts.z);
}

void SceneBuilder::revolve(glm::vec3 center, const std::vector<glm::vec2>& profile, int n_around, uint32_t material,
                           bool inward, float repeats) {
  const auto n = static_cast<uint32_t>(n_around);
  const float flip = inward ? -1.0f : 1.0f;
  std::vector<uint32_t> first;  // vertex of each profile point at angle 0; one extra column closes the texture
  for (size_t k = 0; k < profile.size(); ++k) {
    const glm::vec2 before = profile[k == 0 ? 0 : k - 1], after = profile[k + 1 == profile.size() ? k : k + 1];
    const glm::vec2 slope = glm::normalize(after - before);
    const float v = 1.0f - static_cast<float>(k) / static_cast<float>(profile.size() - 1);
    first.push_back(static_cast<uint32_t>(scene_.mesh.vertices.size()));
    for (uint32_t i = 0; i <= n; ++i) {
      const double angle = 2.0 * kPi * (i % n) / n;
      const auto c = static_cast<float>(exact_cos(angle)), s = static_cast<float>(exact_sin(angle));
      const glm::vec3 outward(c * slope.y, -slope.x, s * slope.y);
      add_vertex(center + glm::vec3(c * profile[k].x, profile[k].y, s * profile[k].x), outward * flip,
                 {repeats * static_cast<float>(i) / static_cast<float>(n), v});
    }
  }
  for (size_t k = 0; k + 1 < profile.size(); ++k) {
    for (uint32_t i = 0; i < n; ++i) {
      // With y up, the angle's direction x -> z is clockwise seen from above: the right-hand neighbour has the smaller
      // i.
      const uint32_t a = first[k] + i + 1, b = first[k] + i, c = first[k + 1] + i, d = first[k + 1] + i + 1;
      if (profile[k].x <= 0.0f) {
        if (inward) {
          add_face({a, d, c}, material);
        } else {
          add_face({a, c, d}, material);
        }
      } else if (profile[k + 1].x <= 0.0f) {
        if (inward) {
          add_face({b, a, c}, material);
        } else {
          add_face({a, b, c}, material);
        }
      } else if (inward) {
        add_face({b, a, d, c}, material);
      } else {
        add_face({a, b, c, d}, material);
      }
    }
  }
}

void SceneBuilder::polygon(const std::vector<glm::vec3>& corners, const std::vector<glm::vec2>& texcoords,
                           uint32_t material) {
  // Newell's normal: right for concave polygons as well.
  glm::vec3 normal(0.0f);
  for (size_t i = 0; i < corners.size(); ++i) {
    const glm::vec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    normal += glm::vec3((a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y));
  }
  normal = glm::normalize(normal);
  Mesh& mesh = scene_.mesh;
  mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(corners.size()), material});
  for (size_t i = 0; i < corners.size(); ++i) mesh.indices.push_back(add_vertex(corners[i], normal, texcoords[i]));
}

}  // namespace pac::sim
