#include "sim/loaded_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "raster/fit_camera.h"

namespace pac::sim {

namespace {

bool finite(const float* p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

struct Box {
  double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};

  double longest_side() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }
};

// Of the finite vertices that faces use; all zero where there is none.
Box bounding_box(const Mesh& mesh) {
  Box box;
  bool first = true;
  for (const uint32_t index : mesh.indices) {
    const float* p = mesh.vertices[index].position;
    if (!finite(p)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = first ? p[axis] : std::min(box.low[axis], double{p[axis]});
      box.high[axis] = first ? p[axis] : std::max(box.high[axis], double{p[axis]});
    }
    first = false;
  }
  return box;
}

void add_default_lights(raster::Scene& scene) {
  raster::Light key, fill;
  key.direction = glm::vec3(-0.48f, -0.64f, -0.6f);
  key.color = glm::vec3(0.85f);
  fill.direction = glm::vec3(0.8f, -0.36f, -0.48f);
  fill.color = glm::vec3(0.3f);
  scene.lights = {key, fill};
}

// Running sums of the vertices that fall into one cell of the clustering grid.
struct Cluster {
  double position[3] = {0, 0, 0}, normal[3] = {0, 0, 0}, texcoord[2] = {0, 0}, color[4] = {0, 0, 0, 0};
  uint32_t count = 0;

  void add(const Vertex& vertex) {
    for (int i = 0; i < 3; ++i) position[i] += vertex.position[i];
    for (int i = 0; i < 3; ++i) normal[i] += vertex.normal[i];
    for (int i = 0; i < 2; ++i) texcoord[i] += vertex.texcoord[i];
    for (int i = 0; i < 4; ++i) color[i] += vertex.color[i];
    ++count;
  }
  Vertex mean() const {
    Vertex vertex;
    const double n = count;
    const double length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int i = 0; i < 3; ++i) vertex.position[i] = static_cast<float>(position[i] / n);
    for (int i = 0; i < 3; ++i) vertex.normal[i] = length > 0 ? static_cast<float>(normal[i] / length) : 0.0f;
    for (int i = 0; i < 2; ++i) vertex.texcoord[i] = static_cast<float>(texcoord[i] / n);
    for (int i = 0; i < 4; ++i) vertex.color[i] = static_cast<uint8_t>(std::floor(color[i] / n + 0.5));
    return vertex;
  }
};

// The grid of the clustering and what fell into it.
struct Clustering {
  Box box;
  double cell = 1;
  std::vector<Cluster> clusters;
  std::vector<uint32_t> numbers;  // cluster of each vertex; UINT32_MAX where the position is not finite
};

// Puts those of the vertices [first, first + count) that have no cluster yet into clusters of their own.
void cluster_vertices(const Mesh& mesh, size_t first, size_t count, Clustering& out) {
  std::unordered_map<uint64_t, uint32_t> number_of_cell;
  for (size_t i = first; i < first + count; ++i) {
    const Vertex& vertex = mesh.vertices[i];
    if (!finite(vertex.position) || out.numbers[i] != UINT32_MAX) continue;
    uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double offset = std::clamp((double{vertex.position[axis]} - out.box.low[axis]) / out.cell, 0.0, 1e6);
      key = key << 21 | static_cast<uint64_t>(offset);  // at most 1024 cells a side: 11 bits each
    }
    const auto [entry, added] = number_of_cell.try_emplace(key, static_cast<uint32_t>(out.clusters.size()));
    if (added) out.clusters.emplace_back();
    out.clusters[entry->second].add(vertex);
    out.numbers[i] = entry->second;
  }
}

// The corners of `face` as clusters, neighbors that fell together merged; fewer than three: the polygon vanished.
std::vector<uint32_t> clustered_corners(const Mesh& mesh, const Face& face, const std::vector<uint32_t>& numbers) {
  std::vector<uint32_t> corners;
  for (uint32_t k = 0; k < face.count; ++k) {
    const uint32_t corner = numbers[mesh.indices[face.first + k]];
    if (corner == UINT32_MAX) return {};
    if (std::find(corners.begin(), corners.end(), corner) == corners.end()) corners.push_back(corner);
  }
  return corners;
}

}  // namespace

SceneSet scene_set_from(raster::Scene scene) {
  SceneSet set;
  bool textured = false;
  for (const raster::Material& material : scene.materials) textured = textured || material.texture >= 0;
  if (scene.lights.empty()) add_default_lights(scene);
  set.fine = std::move(scene);
  set.default_split = textured ? "texture" : "shading";
  return set;
}

raster::Camera fit_camera(const raster::Scene& scene, int frame, float aspect) {
  return raster::orbit_camera(scene, aspect, frame);
}

bool add_coarse_model(SceneSet& scene, int cells) {
  PAC_ASSERT(cells >= 2 && cells <= 1024);
  scene.coarse = raster::Scene{};
  const Mesh& fine = scene.fine.mesh;
  const Box box = bounding_box(fine);
  const double side = box.longest_side();
  if (!(side > 0) || !std::isfinite(side)) return false;

  Clustering clustering{box, side * (1 + 1e-9) / cells, {}, std::vector<uint32_t>(fine.vertices.size(), UINT32_MAX)};
  // Vertices that move together stay together; they may not become one with others.
  std::vector<raster::Object> objects = scene.fine.objects;
  for (raster::Object& object : objects) {
    const size_t before = clustering.clusters.size();
    cluster_vertices(fine, object.first_vertex, object.vertex_count, clustering);
    object.first_vertex = static_cast<uint32_t>(before);
    object.vertex_count = static_cast<uint32_t>(clustering.clusters.size() - before);
  }
  cluster_vertices(fine, 0, fine.vertices.size(), clustering);
  Mesh coarse;
  for (const Cluster& cluster : clustering.clusters) coarse.vertices.push_back(cluster.mean());
  for (const Face& face : fine.faces) {
    const std::vector<uint32_t> corners = clustered_corners(fine, face, clustering.numbers);
    if (corners.size() < 3) continue;
    coarse.faces.push_back(
        {static_cast<uint32_t>(coarse.indices.size()), static_cast<uint32_t>(corners.size()), face.material});
    coarse.indices.insert(coarse.indices.end(), corners.begin(), corners.end());
  }
  if (coarse.faces.empty() || coarse.faces.size() >= fine.faces.size()) return false;
  scene.coarse = scene.fine;
  scene.coarse.mesh = std::move(coarse);
  scene.coarse.objects = std::move(objects);
  return true;
}

}  // namespace pac::sim
