// What geom_peers measures: scenes of this project, Debian's test models, and generated meshes of the kinds that
// meshes come in: surfaces cut from volumes (with and without noise), terrain, parts with hard edges, soup, repetition.
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <utility>

#include "base/exact_math.h"
#include "base/file_io.h"
#include "bench/peers/geom_peers.h"
#include "raster/load_ply.h"
#include "sim/scenes.h"

namespace pac::peers {
namespace {

using Point = std::array<double, 3>;

class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed * 2 + 1) {}
  double unit() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 40) / 16777216.0;
  }

 private:
  uint64_t state_;
};

uint32_t add_vertex(Mesh& mesh, const Point& p, double u = 0, double v = 0) {
  Vertex vertex;
  for (size_t i = 0; i < 3; ++i) vertex.position[i] = static_cast<float>(p[i]);
  vertex.texcoord[0] = static_cast<float>(u);
  vertex.texcoord[1] = static_cast<float>(v);
  mesh.vertices.push_back(vertex);
  return static_cast<uint32_t>(mesh.vertices.size() - 1);
}

void add_face(Mesh& mesh, std::initializer_list<uint32_t> corners) {
  mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(corners.size()), 0});
  mesh.indices.insert(mesh.indices.end(), corners);
}

Point cross_product(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Area-weighted vertex normals.
void add_normals(Mesh& mesh) {
  std::vector<Point> normal(mesh.vertices.size());
  const auto at = [&](uint32_t v) {
    const float* p = mesh.vertices[v].position;
    return Point{p[0], p[1], p[2]};
  };
  for (const Face& face : mesh.faces) {
    for (uint32_t k = 0; k < face.count; ++k) {
      const auto index = [&](uint32_t i) { return mesh.indices[face.first + i % face.count]; };
      const Point here = at(index(k)), next = at(index(k + 1)), before = at(index(k + face.count - 1));
      const Point n = cross_product({next[0] - here[0], next[1] - here[1], next[2] - here[2]},
                                    {before[0] - here[0], before[1] - here[1], before[2] - here[2]});
      for (size_t i = 0; i < 3; ++i) normal[index(k)][i] += n[i];
    }
  }
  for (size_t v = 0; v < normal.size(); ++v) {
    const Point& n = normal[v];
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (size_t i = 0; i < 3; ++i)
      mesh.vertices[v].normal[i] = static_cast<float>(length > 0 ? n[i] / length : (i == 2 ? 1.0 : 0.0));
  }
}

// Two lights, a highlight and a slow pattern.
void shade(Mesh& mesh) {
  for (Vertex& vertex : mesh.vertices) {
    const float* n = vertex.normal;
    const double key = std::max(0.0, 0.5 * n[0] + 0.6 * n[1] + 0.62 * n[2]);
    const double fill = std::max(0.0, -0.8 * n[0] + 0.2 * n[1] + 0.5 * n[2]), gloss = key * key * key * key;
    const double light[3] = {0.2 + 0.6 * key + 0.1 * fill, 0.2 + 0.58 * key + 0.12 * fill,
                             0.22 + 0.5 * key + 0.2 * fill};
    const double albedo[3] = {0.8, 0.6, 0.5};
    for (int c = 0; c < 3; ++c)
      vertex.color[c] = static_cast<uint8_t>(255 * std::min(1.0, light[c] * albedo[c] + 0.25 * gloss * gloss) + 0.5);
    vertex.color[3] = 255;
  }
}

// The surface where a field vanishes, by marching tetrahedra: as irregular as scans are.
class Volume {
 public:
  Volume(int n, double noise, uint64_t seed) : n_(n), noise_(noise), random_(seed) {}
  Mesh surface() {
    for (int z = 0; z < n_; ++z)
      for (int y = 0; y < n_; ++y)
        for (int x = 0; x < n_; ++x) cell(x, y, z);
    return std::move(mesh_);
  }

 private:
  double field(const Point& p) const {
    const double r2 = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    return r2 - 0.55 - 0.18 * exact_sin(5 * p[0] + 1) * exact_cos(4 * p[1]) - 0.12 * exact_sin(7 * p[2] + 3 * p[0]);
  }
  Point place(uint32_t id) const {
    const auto side = static_cast<uint32_t>(n_ + 1);
    return {2.4 * (id % side) / n_ - 1.2, 2.4 * (id / side % side) / n_ - 1.2, 2.4 * (id / side / side) / n_ - 1.2};
  }
  void cell(int x, int y, int z) {
    const auto id = [&](int i) {
      return static_cast<uint32_t>(((z + (i >> 2)) * (n_ + 1) + y + (i >> 1 & 1)) * (n_ + 1) + x + (i & 1));
    };
    static constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                              {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    for (const auto& t : kTetrahedra) tetrahedron({id(t[0]), id(t[1]), id(t[2]), id(t[3])});
  }
  void tetrahedron(const std::array<uint32_t, 4>& corner) {
    std::vector<uint32_t> in, out;
    for (const uint32_t c : corner) (field(place(c)) < 0 ? in : out).push_back(c);
    if (in.size() == 1)
      triangle(crossing(in[0], out[0]), crossing(in[0], out[1]), crossing(in[0], out[2]), in[0]);
    else if (in.size() == 3)
      triangle(crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0]), in[0]);
    else if (in.size() == 2) {
      const uint32_t a = crossing(in[0], out[0]), b = crossing(in[0], out[1]), c = crossing(in[1], out[1]),
                     d = crossing(in[1], out[0]);
      triangle(a, b, c, in[0]);
      triangle(a, c, d, in[0]);
    }
  }
  uint32_t crossing(uint32_t in, uint32_t out) {
    const auto [entry, added] = crossing_.try_emplace({std::min(in, out), std::max(in, out)}, 0);
    if (!added) return entry->second;
    const Point a = place(in), b = place(out);
    const double fa = field(a), fb = field(b), t = std::clamp(fa / (fa - fb), 0.05, 0.95);
    Point p;
    for (size_t i = 0; i < 3; ++i) p[i] = a[i] + t * (b[i] - a[i]) + noise_ / n_ * (random_.unit() - 0.5);
    return entry->second = add_vertex(mesh_, p, p[0], p[1]);
  }
  void triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t inside) {
    const auto at = [&](uint32_t v) {
      const float* p = mesh_.vertices[v].position;
      return Point{p[0], p[1], p[2]};
    };
    const Point p = at(a), q = at(b), r = at(c), i = place(inside);
    const Point n = cross_product({q[0] - p[0], q[1] - p[1], q[2] - p[2]}, {r[0] - p[0], r[1] - p[1], r[2] - p[2]});
    if (n[0] * (i[0] - p[0]) + n[1] * (i[1] - p[1]) + n[2] * (i[2] - p[2]) > 0) std::swap(b, c);
    add_face(mesh_, {a, b, c});
  }

  int n_;
  double noise_;
  Random random_;
  Mesh mesh_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> crossing_;
};

// A height field; columns x rows cells.
Mesh terrain(uint32_t columns, uint32_t rows, bool quads, double noise) {
  Mesh mesh;
  Random random(columns);
  for (uint32_t y = 0; y <= rows; ++y) {
    for (uint32_t x = 0; x <= columns; ++x) {
      const double s = static_cast<double>(x) / columns, t = static_cast<double>(y) / rows;
      const double height = 0.08 * exact_sin(9 * s + 2 * t) * exact_cos(7 * t) + 0.03 * exact_sin(31 * s * t + 3) +
                            noise / columns * (random.unit() - 0.5);
      add_vertex(mesh, {s, t * rows / columns, height}, s, t);
    }
  }
  for (uint32_t y = 0; y < rows; ++y) {
    for (uint32_t x = 0; x < columns; ++x) {
      const uint32_t a = y * (columns + 1) + x, b = a + 1, c = b + columns + 1, d = c - 1;
      if (quads) {
        add_face(mesh, {a, b, c, d});
      } else {
        add_face(mesh, {a, b, c});
        add_face(mesh, {a, c, d});
      }
    }
  }
  return mesh;
}

// A toothed wheel with a bore: flat caps, hard edges with vertices of their own.
Mesh wheel(uint32_t teeth) {
  Mesh mesh;
  const uint32_t n = 4 * teeth;
  const auto ring = [&](uint32_t k, bool outer, double z) {
    const double angle = 2 * kPi * k / n, radius = outer ? ((k / 2) % 2 == 0 ? 1.0 : 0.86) : 0.35;
    return Point{radius * exact_cos(angle), radius * exact_sin(angle), z};
  };
  const auto side = [&](const Point& a, const Point& b, const Point& c, const Point& d) {
    const uint32_t i = add_vertex(mesh, a, 0, 0), j = add_vertex(mesh, b, 1, 0), k = add_vertex(mesh, c, 1, 1),
                   l = add_vertex(mesh, d, 0, 1);
    add_face(mesh, {i, j, k});
    add_face(mesh, {i, k, l});
  };
  for (uint32_t k = 0; k < n; ++k) {
    side(ring(k, true, 0), ring(k + 1, true, 0), ring(k + 1, true, 0.3), ring(k, true, 0.3));
    side(ring(k + 1, false, 0), ring(k, false, 0), ring(k, false, 0.3), ring(k + 1, false, 0.3));
  }
  for (const double z : {0.0, 0.3}) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (uint32_t k = 0; k < n; ++k)
      for (const bool outer : {false, true})
        add_vertex(mesh, ring(k, outer, z), ring(k, outer, z)[0], ring(k, outer, z)[1]);
    for (uint32_t k = 0; k < n; ++k) {
      const uint32_t a = first + 2 * k, b = a + 1, c = first + 2 * ((k + 1) % n), d = c + 1;
      if (z > 0) {
        add_face(mesh, {a, b, d});
        add_face(mesh, {a, d, c});
      } else {
        add_face(mesh, {a, d, b});
        add_face(mesh, {a, c, d});
      }
    }
  }
  return mesh;
}

Mesh soup(uint32_t n_triangles) {
  Mesh mesh;
  Random random(4);
  for (uint32_t i = 0; i < n_triangles; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double x = random.unit(), y = random.unit(), z = random.unit();
      add_vertex(mesh, {x, y, z}, x, z);
    }
    add_face(mesh, {3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

Mesh equal_quads(uint32_t side) {
  Mesh mesh;
  for (uint32_t y = 0; y < 25; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t a = add_vertex(mesh, {x * 1.25, y * 1.5, 0}, 0, 0),
                     b = add_vertex(mesh, {x * 1.25 + 1, y * 1.5, 0}, 1, 0);
      const uint32_t c = add_vertex(mesh, {x * 1.25 + 1, y * 1.5 + 1, 0}, 1, 1),
                     d = add_vertex(mesh, {x * 1.25, y * 1.5 + 1, 0}, 0, 1);
      add_face(mesh, {a, b, c});
      add_face(mesh, {a, c, d});
    }
  }
  return mesh;
}

Mesh torus(uint32_t around, uint32_t across) {
  Mesh mesh;
  for (uint32_t j = 0; j <= across; ++j) {
    for (uint32_t i = 0; i <= around; ++i) {
      const double a = 2 * kPi * (i % around) / around, b = 2 * kPi * (j % across) / across, r = 1 + 0.4 * exact_cos(b);
      add_vertex(mesh, {r * exact_cos(a), r * exact_sin(a), 0.4 * exact_sin(b)}, 4.0 * i / around, 1.0 * j / across);
    }
  }
  for (uint32_t j = 0; j < across; ++j) {
    for (uint32_t i = 0; i < around; ++i) {
      const uint32_t a = j * (around + 1) + i, b = a + 1, c = b + around + 1, d = c - 1;
      add_face(mesh, {a, b, c});
      add_face(mesh, {a, c, d});
    }
  }
  return mesh;
}

void add_generated(std::vector<NamedMesh>& meshes, const std::string& name, Mesh mesh) {
  add_normals(mesh);
  shade(mesh);
  meshes.push_back({name, std::move(mesh), true});
}

void add_scenes(std::vector<NamedMesh>& meshes, int size) {
  for (const char* name : {"room", "pin"}) {
    const sim::BuiltinScene* scene = sim::find_scene(name);
    if (scene == nullptr) continue;
    const sim::SceneSet set = scene->build(1);
    if (!set.coarse.mesh.faces.empty()) meshes.push_back({std::string(name) + " coarse", set.coarse.mesh, false});
    if (set.fine.mesh.faces.size() < 10000 || size > 0) meshes.push_back({name, set.fine.mesh, false});
  }
}

}  // namespace

bool load_file(const std::string& path, NamedMesh& out) {
  const auto bytes = read_file(path);
  if (!bytes.ok()) return false;
  auto loaded = raster::load_model(*bytes, {});
  if (!loaded.ok() || loaded->scene.mesh.faces.empty()) return false;
  out.name = path.substr(path.find_last_of('/') + 1);
  out.mesh = std::move(loaded->scene.mesh);
  shade(out.mesh);
  out.has_texcoords = std::any_of(out.mesh.vertices.begin(), out.mesh.vertices.end(), [](const Vertex& vertex) {
    return vertex.texcoord[0] != 0 || vertex.texcoord[1] != 0;
  });
  return true;
}

std::vector<NamedMesh> test_meshes(int size) {
  std::vector<NamedMesh> meshes;
  add_scenes(meshes, size);
  for (const char* file : {"OBJ/spider.obj", "OBJ/WusonOBJ.obj", "OBJ/regr01.obj", "PLY/Wuson.ply", "PLY/pond.0.ply"}) {
    NamedMesh mesh;
    if (load_file(std::string("/usr/share/assimp/models/") + file, mesh) &&
        (size > 0 || mesh.mesh.faces.size() < 20000))
      meshes.push_back(std::move(mesh));
  }
  add_generated(meshes, "blob", Volume(16, 0, 1).surface());
  add_generated(meshes, "blob, noisy", Volume(16, 0.4, 2).surface());
  add_generated(meshes, "terrain", terrain(50, 40, false, 0.5));
  add_generated(meshes, "terrain, quads", terrain(50, 40, true, 0));
  add_generated(meshes, "torus", torus(48, 32));
  add_generated(meshes, "wheel", wheel(40));
  add_generated(meshes, "soup", soup(3000));
  add_generated(meshes, "1000 quads", equal_quads(40));
  if (size == 0) return meshes;
  add_generated(meshes, "blob 75k", Volume(66, 0, 3).surface());
  add_generated(meshes, "blob 75k, noisy", Volume(66, 0.3, 4).surface());
  add_generated(meshes, "terrain 76k", terrain(200, 190, false, 0.5));
  return meshes;
}

}  // namespace pac::peers
