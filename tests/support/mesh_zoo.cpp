#include "tests/support/mesh_zoo.h"

#include <algorithm>
#include <initializer_list>

#include "base/exact_math.h"

namespace pac::test {
namespace {

using geomcodec::QuantizedMesh;
using geomcodec::QuantizedVertex;

class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed * 2 + 1) {}
  uint32_t below(uint32_t limit) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>((state_ >> 33) % limit);
  }

 private:
  uint64_t state_;
};

void add_face(QuantizedMesh& mesh, std::initializer_list<uint32_t> corners, uint32_t material = 0) {
  mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(corners.size()), material});
  mesh.indices.insert(mesh.indices.end(), corners);
}

void add_vertex(QuantizedMesh& mesh, uint32_t x, uint32_t y, uint32_t z) {
  QuantizedVertex vertex;
  vertex.position[0] = static_cast<uint16_t>(x);
  vertex.position[1] = static_cast<uint16_t>(y);
  vertex.position[2] = static_cast<uint16_t>(z);
  vertex.color[0] = static_cast<uint8_t>(x >> 8);
  vertex.color[1] = static_cast<uint8_t>(y >> 8);
  mesh.vertices.push_back(vertex);
}

void add_random_vertices(QuantizedMesh& mesh, Random& random, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t x = random.below(65536), y = random.below(65536), z = random.below(65536);
    add_vertex(mesh, x, y, z);
    for (uint8_t& channel : mesh.vertices.back().color) channel = static_cast<uint8_t>(random.below(256));
  }
}

QuantizedMesh without_faces(uint32_t n_vertices) {
  QuantizedMesh mesh;
  Random random(5);
  add_random_vertices(mesh, random, n_vertices);
  return mesh;
}

QuantizedMesh polygon(uint32_t n_corners) {
  QuantizedMesh mesh;
  mesh.faces.push_back({0, n_corners, 3});
  for (uint32_t i = 0; i < n_corners; ++i) {
    const double angle = 2 * kPi * i / n_corners;
    add_vertex(mesh, static_cast<uint32_t>(32768 + 30000 * exact_cos(angle)),
               static_cast<uint32_t>(32768 + 30000 * exact_sin(angle)), 17);
    mesh.indices.push_back(i);
  }
  return mesh;
}

QuantizedMesh fan(uint32_t valence) {
  QuantizedMesh mesh = polygon(valence);
  mesh.faces.clear();
  mesh.indices.clear();
  add_vertex(mesh, 32768, 32768, 40000);
  for (uint32_t i = 0; i < valence; ++i) add_face(mesh, {valence, i, (i + 1) % valence});
  return mesh;
}

QuantizedMesh moebius(uint32_t n) {
  QuantizedMesh mesh;
  for (uint32_t i = 0; i < n; ++i) {
    add_vertex(mesh, 1000 + 100 * i, 2000, 3000);
    add_vertex(mesh, 1000 + 100 * i, 2500, 3300);
  }
  for (uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const uint32_t a = 2 * i, b = 2 * i + 1, c = last ? 1 : 2 * i + 2, d = last ? 0 : 2 * i + 3;
    add_face(mesh, {a, b, c});
    add_face(mesh, {b, d, c});
  }
  return mesh;
}

QuantizedMesh random_soup(uint32_t n_vertices, uint32_t n_faces, uint32_t max_corners) {
  QuantizedMesh mesh;
  Random random(77 + n_faces);
  add_random_vertices(mesh, random, n_vertices);
  for (uint32_t f = 0; f < n_faces; ++f) {
    const uint32_t count = 3 + random.below(max_corners - 2), material = random.below(5);
    mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), count, material});
    for (uint32_t k = 0; k < count; ++k) mesh.indices.push_back(random.below(n_vertices));
  }
  return mesh;
}

QuantizedMesh equal_quads(uint32_t count) {
  QuantizedMesh mesh;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t x = 60 * i;
    add_vertex(mesh, x, 0, 7);
    add_vertex(mesh, x + 40, 0, 7);
    add_vertex(mesh, x + 40, 50, 7);
    add_vertex(mesh, x, 50, 7);
    add_face(mesh, {4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
  }
  return mesh;
}

QuantizedMesh fins(uint32_t count) {
  QuantizedMesh mesh;
  add_vertex(mesh, 100, 100, 0);
  add_vertex(mesh, 100, 100, 9000);
  for (uint32_t i = 0; i < count; ++i) {
    add_vertex(mesh, 200 + 37 * i, 300 + 91 * (i % 7), 4500);
    add_face(mesh, {i % 2, 1 - i % 2, i + 2});
  }
  return mesh;
}

QuantizedMesh bow_tie(uint32_t count) {
  QuantizedMesh mesh;
  add_vertex(mesh, 32768, 32768, 0);
  for (uint32_t i = 0; i < count; ++i) {
    add_vertex(mesh, 3000 * i, 100, 7);
    add_vertex(mesh, 3000 * i, 900, 9);
    add_face(mesh, {0, 2 * i + 1, 2 * i + 2});
  }
  return mesh;
}

QuantizedMesh shuffled(QuantizedMesh mesh) {
  Random random(3);
  for (size_t i = mesh.faces.size(); i > 1; --i)
    std::swap(mesh.faces[i - 1], mesh.faces[random.below(static_cast<uint32_t>(i))]);
  for (const Face& face : mesh.faces) {
    const auto begin = mesh.indices.begin() + face.first;
    std::rotate(begin, begin + random.below(face.count), begin + face.count);
  }
  return packed(mesh);
}

QuantizedMesh random_winding(QuantizedMesh mesh) {
  Random random(9);
  for (const Face& face : mesh.faces)
    if (random.below(2) == 0)
      std::reverse(mesh.indices.begin() + face.first, mesh.indices.begin() + face.first + face.count);
  return mesh;
}

QuantizedMesh with_duplicates(QuantizedMesh mesh, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) {
    const Face face = mesh.faces[i % 3];
    mesh.faces.push_back(face);
  }
  return packed(mesh);
}

QuantizedMesh with_isolated(QuantizedMesh mesh, uint32_t count) {
  Random random(4);
  for (uint32_t i = 0; i < count; ++i) {
    const auto at = static_cast<uint32_t>(random.below(static_cast<uint32_t>(mesh.vertices.size())));
    mesh.vertices.insert(mesh.vertices.begin() + at, mesh.vertices[at]);
    for (uint32_t& index : mesh.indices)
      if (index >= at) ++index;
  }
  return mesh;
}

QuantizedMesh degenerate() {
  QuantizedMesh mesh = without_faces(6);
  add_face(mesh, {0, 0, 1});
  add_face(mesh, {2, 2, 2});
  add_face(mesh, {0, 1, 0, 1});
  add_face(mesh, {1, 0, 2, 0, 1}, 0xFFFFFFFFu);
  add_face(mesh, {5, 4, 3, 4, 5, 4});
  return mesh;
}

// Triangles that rounding has closed on the edges of faces, and some at one point; of every other one a corner has a
// vertex of its own.
QuantizedMesh with_slivers(QuantizedMesh mesh, uint32_t count) {
  Random random(31);
  const auto n_faces = static_cast<uint32_t>(mesh.faces.size());
  for (uint32_t i = 0; i < count; ++i) {
    const Face face = mesh.faces[random.below(n_faces)];
    const auto k = static_cast<uint32_t>(random.below(face.count));
    const uint32_t a = mesh.indices[face.first + k], b = mesh.indices[face.first + (k + 1) % face.count];
    uint32_t twin = random.below(9) == 0 ? b : a;  // at a's point, or all at b's
    const uint32_t other = twin == b ? b : a;
    if (i % 2 == 1) {
      mesh.vertices.push_back(mesh.vertices[twin]);
      twin = static_cast<uint32_t>(mesh.vertices.size() - 1);
    }
    if (random.below(2) == 0)
      add_face(mesh, {other, twin, b}, i % 3);
    else
      add_face(mesh, {twin, other, b}, i % 3);
  }
  return mesh;
}

QuantizedMesh extremes(int bits) {
  QuantizedMesh mesh = without_faces(64);
  Random random(11);
  for (QuantizedVertex& vertex : mesh.vertices)
    for (uint16_t& coordinate : vertex.position)
      coordinate = random.below(2) == 0 ? uint16_t{0} : static_cast<uint16_t>((1 << bits) - 1);
  mesh.position_bits = bits;
  for (uint32_t i = 0; i + 2 < 64; ++i) add_face(mesh, {i, i + 1 + i % 2, i + 2 - i % 2});
  return mesh;
}

// A vertex of its own for every corner of every n-th face: hard edges, seams.
QuantizedMesh with_seams(QuantizedMesh mesh, uint32_t every) {
  for (size_t f = 0; f < mesh.faces.size(); f += every) {
    for (uint32_t k = 0; k < mesh.faces[f].count; ++k) {
      uint32_t& index = mesh.indices[mesh.faces[f].first + k];
      mesh.vertices.push_back(mesh.vertices[index]);
      index = static_cast<uint32_t>(mesh.vertices.size() - 1);
      if (f % 2 == 0) mesh.vertices.back().color[1] = static_cast<uint8_t>(mesh.vertices.back().color[1] ^ 0x5A);
    }
  }
  return mesh;
}

// Normals and texture coordinates: near what the shape suggests, some anywhere, some equal.
QuantizedMesh with_attributes(QuantizedMesh mesh, int normal_bits, int texcoord_bits) {
  Random random(21);
  mesh.normal_bits = normal_bits;
  mesh.texcoord_bits = texcoord_bits;
  if (texcoord_bits > 0) mesh.texcoord_origin[1] = -0.5f, mesh.texcoord_step = 0.25f;
  const uint32_t top = normal_bits == 0 ? 0 : (1u << normal_bits) - 2, mask = (1u << texcoord_bits) - 1;
  for (QuantizedVertex& vertex : mesh.vertices) {
    for (int i = 0; i < 2; ++i) {
      const uint32_t kind = random.below(8), any = random.below(65536);
      vertex.normal[i] = static_cast<uint16_t>(top == 0    ? 0
                                               : kind == 0 ? any % (top + 1)
                                               : kind == 1 ? (any & 1) * top
                                                           : top / 2 + vertex.color[0] * top / 1024);
      vertex.texcoord[i] = static_cast<uint16_t>((kind == 2 ? any : vertex.position[i] >> 3) & mask);
    }
  }
  return mesh;
}

// Values of faces: some smooth, some that only change here and there, some anywhere.
QuantizedMesh with_face_values(QuantizedMesh mesh, int components, int bits) {
  Random random(31);
  mesh.face_bits = bits;
  mesh.face_components = components;
  const uint32_t mask = (1u << bits) - 1;
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (int c = 0; c < components; ++c)
      mesh.face_values.push_back(static_cast<uint16_t>((c == 0   ? f / 64 * 1001
                                                        : c == 1 ? f * 3
                                                        : c == 2 ? random.below(65536)
                                                                 : f + random.below(5)) &
                                                       mask));
  return mesh;
}

QuantizedMesh strip(uint32_t n_vertices) {
  QuantizedMesh mesh;
  for (uint32_t i = 0; i < n_vertices; ++i) add_vertex(mesh, i & 0xFFFF, (i % 2) * 50, i >> 12);
  for (uint32_t i = 0; i + 2 < n_vertices; i += 40) add_face(mesh, {i, i + 1, i + 2});
  return mesh;
}

}  // namespace

QuantizedMesh packed(const QuantizedMesh& mesh) {
  QuantizedMesh result = mesh;
  result.indices.clear();
  for (Face& face : result.faces) {
    const uint32_t first = face.first;
    face.first = static_cast<uint32_t>(result.indices.size());
    for (uint32_t k = 0; k < face.count; ++k) result.indices.push_back(mesh.indices[first + k]);
  }
  return result;
}

bool same(const QuantizedMesh& one, const QuantizedMesh& other) {
  return one.normal_bits == other.normal_bits && one.texcoord_bits == other.texcoord_bits &&
         std::equal(one.texcoord_origin, one.texcoord_origin + 2, other.texcoord_origin) &&
         one.texcoord_step == other.texcoord_step && one.vertices == other.vertices && one.indices == other.indices &&
         one.position_bits == other.position_bits && std::equal(one.origin, one.origin + 3, other.origin) &&
         std::equal(one.step, one.step + 3, other.step) && one.face_bits == other.face_bits &&
         one.face_components == other.face_components && one.face_values == other.face_values &&
         std::equal(one.faces.begin(), one.faces.end(), other.faces.begin(), other.faces.end(),
                    [](const Face& a, const Face& b) {
                      return a.first == b.first && a.count == b.count && a.material == b.material;
                    });
}

QuantizedMesh wave_mesh(uint32_t columns, uint32_t rows, bool triangles) {
  QuantizedMesh mesh;
  for (uint32_t y = 0; y <= rows; ++y) {
    for (uint32_t x = 0; x <= columns; ++x) {
      const double height = exact_sin(x * 0.3) * exact_cos(y * 0.2);
      add_vertex(mesh, x * 65535 / columns, y * 65535 / rows, static_cast<uint32_t>(32768 + 9000 * height));
      mesh.vertices.back().color[2] = static_cast<uint8_t>(128 + 100 * height);
    }
  }
  for (uint32_t y = 0; y < rows; ++y) {
    for (uint32_t x = 0; x < columns; ++x) {
      const uint32_t a = y * (columns + 1) + x, b = a + 1, c = b + columns + 1, d = c - 1;
      if (triangles) {
        add_face(mesh, {a, b, c}, x / 4 % 3);
        add_face(mesh, {a, c, d}, x / 4 % 3);
      } else {
        add_face(mesh, {a, b, c, d}, x / 4 % 3);
      }
    }
  }
  return mesh;
}

QuantizedMesh pin_mesh(uint32_t segments, uint32_t rings, int position_bits) {
  Mesh mesh;
  for (uint32_t r = 0; r <= rings; ++r) {
    const double t = static_cast<double>(r) / rings;
    const double radius = exact_sin(kPi * t) * (0.35 + 0.15 * exact_sin(5.5 * t)) + 0.01;
    for (uint32_t s = 0; s < segments; ++s) {
      const double angle = 2 * kPi * s / segments, x = exact_cos(angle), y = exact_sin(angle);
      Vertex vertex;
      vertex.position[0] = static_cast<float>(radius * x);
      vertex.position[1] = static_cast<float>(radius * y);
      vertex.position[2] = static_cast<float>(2.5 * t);
      const double light = std::max(0.0, 0.6 * x + 0.5 * y + 0.3 * (t - 0.5)), gloss = light * light * light * light;
      const double albedo[3] = {0.9, 0.85 - 0.3 * exact_sin(9 * t), 0.7};
      for (int c = 0; c < 3; ++c)
        vertex.color[c] =
            static_cast<uint8_t>(std::clamp(255 * (albedo[c] * (0.15 + 0.7 * light) + 0.3 * gloss), 0.0, 255.0));
      mesh.vertices.push_back(vertex);
    }
  }
  QuantizedMesh result = geomcodec::quantize(mesh, position_bits).value();
  for (uint32_t r = 0; r < rings; ++r) {
    for (uint32_t s = 0; s < segments; ++s) {
      const uint32_t a = r * segments + s, b = r * segments + (s + 1) % segments, c = b + segments, d = a + segments;
      add_face(result, {a, b, c});
      add_face(result, {a, c, d});
    }
  }
  return result;
}

QuantizedMesh copies_mesh(uint32_t count) {
  QuantizedMesh mesh;
  mesh.position_bits = 14;
  Random random(41);
  for (uint32_t i = 0; i < count; ++i) {
    const bool odd = i % 7 == 6;
    const uint32_t side = odd ? 2 + random.below(4) : i % 2 == 0 ? 5 : 3;
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x) {
        const uint32_t noise = odd ? random.below(50) : 0, left = random.below(2), low = random.below(2);
        const uint32_t bend = (x * x * 37 + y * y * y * 23 + x * y * 11 + noise) % 300;
        add_vertex(mesh, 3 * 301 * i / 8 + 67 * x + left, 500 + 71 * y + 13 * x + low, 90 + bend);
      }
    for (uint32_t y = 0; y + 1 < side; ++y)
      for (uint32_t x = 0; x + 1 < side; ++x) {
        const uint32_t a = first + y * side + x;
        add_face(mesh, {a, a + 1, a + side + 1});
        add_face(mesh, {a, a + side + 1, a + side});
      }
  }
  return mesh;
}

QuantizedMesh irregular_mesh(uint32_t side) {
  QuantizedMesh mesh;
  mesh.position_bits = 14;
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      QuantizedVertex vertex;
      vertex.position[0] = static_cast<uint16_t>(100 * x);
      vertex.position[1] = static_cast<uint16_t>(100 * y);
      vertex.position[2] = static_cast<uint16_t>(3000 + (x * x + 2 * y * y) / 3);
      mesh.vertices.push_back(vertex);
    }
  std::vector<std::array<uint32_t, 3>> triangles;
  for (uint32_t y = 0; y + 1 < side; ++y)
    for (uint32_t x = 0; x + 1 < side; ++x) {
      const uint32_t a = y * side + x, b = a + 1, c = b + side, d = a + side;
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  const auto turns = [&](uint32_t a, uint32_t b, uint32_t c) {  // left, seen from above
    const auto at = [&](uint32_t v, int axis) { return int64_t{mesh.vertices[v].position[axis]}; };
    return (at(b, 0) - at(a, 0)) * (at(c, 1) - at(a, 1)) - (at(b, 1) - at(a, 1)) * (at(c, 0) - at(a, 0)) > 0;
  };
  Random random(77);
  for (uint32_t i = 0; i < 12 * side; ++i)
    for (size_t t = random.below(7); t < triangles.size(); t += 1 + random.below(13)) {
      auto& [a, b, c] = triangles[t];
      std::rotate(triangles[t].begin(), triangles[t].begin() + random.below(3), triangles[t].end());
      const size_t near = std::min(t + 1 + random.below(2 * side), triangles.size() - 1);
      auto& other = triangles[near];
      for (int k = 0; k < 3; ++k, std::rotate(other.begin(), other.begin() + 1, other.end())) {
        if (near == t || other[0] != c || other[1] != b) continue;  // the edge b -> c the other way round
        const uint32_t d = other[2];
        if (!turns(a, b, d) || !turns(a, d, c)) break;
        other = {a, d, c};
        c = d;
        break;
      }
    }
  for (const auto& [a, b, c] : triangles) add_face(mesh, {a, b, c});
  return mesh;
}

std::vector<NamedMesh> mesh_zoo() {
  std::vector<NamedMesh> zoo;
  const auto add = [&](const char* name, QuantizedMesh mesh) { zoo.push_back({name, std::move(mesh)}); };
  add("empty", {});
  add("vertices only", without_faces(70));
  add("one triangle", polygon(3));
  add("one quad", polygon(4));
  add("one polygon of 1000 corners", polygon(1000));
  add("triangle grid", wave_mesh(20, 15, true));
  add("quad grid", wave_mesh(20, 15, false));
  add("pin", pin_mesh(24, 40, 11));
  add("fan of valence 10000", fan(10000));
  add("Moebius strip", moebius(40));
  add("triangle soup", random_soup(3000, 1000, 3));
  add("random indices", random_soup(500, 900, 3));
  add("random polygons", random_soup(60, 300, 9));
  add("1000 equal quads", equal_quads(1000));
  add("copies among others", copies_mesh(18));
  add("copies with hard edges", with_attributes(with_seams(copies_mesh(40), 9), 8, 0));
  add("fins on one edge", fins(200));
  add("bow-tie", bow_tie(12));
  add("faces in random order", shuffled(wave_mesh(30, 20, true)));
  add("random winding", random_winding(wave_mesh(20, 20, true)));
  add("duplicate faces", with_duplicates(wave_mesh(4, 4, false), 60));
  add("isolated vertices", with_isolated(wave_mesh(8, 8, false), 50));
  add("degenerate faces", degenerate());
  add("slivers", with_slivers(wave_mesh(14, 11, true), 120));
  add("slivers among quads", shuffled(with_slivers(wave_mesh(9, 8, false), 40)));
  add("slivers with attributes",
      with_face_values(with_attributes(with_slivers(with_seams(wave_mesh(12, 8, true), 6), 50), 10, 12), 2, 8));
  add("many slivers on few edges", with_slivers(wave_mesh(2, 1, true), 300));
  add("pin of 4 bits", pin_mesh(16, 24, 4));
  add("any valence", irregular_mesh(12));
  add("any valence, hard edges", with_slivers(with_seams(irregular_mesh(9), 4), 12));
  add("extremes of 16 bits", extremes(16));
  add("one bit", extremes(1));
  add("hard edges", with_seams(wave_mesh(12, 9, true), 1));
  add("some seams", with_seams(wave_mesh(12, 9, false), 5));
  add("normals and texture", with_attributes(with_seams(wave_mesh(14, 9, true), 7), 10, 12));
  add("normals and texture on quads", with_attributes(with_seams(wave_mesh(10, 9, false), 6), 16, 16));
  add("coarsest normals and texture", with_attributes(random_soup(80, 100, 5), 2, 1));
  add("normals of lone vertices", with_attributes(with_isolated(wave_mesh(4, 4, true), 9), 8, 0));
  add("texture on degenerate faces", with_attributes(degenerate(), 0, 14));
  add("values of triangles", with_face_values(wave_mesh(14, 9, true), 4, 8));
  add("values of polygons", with_face_values(with_seams(random_soup(60, 120, 9), 4), 3, 16));
  add("one bit a face", with_face_values(wave_mesh(6, 5, false), 1, 1));
  add("equal parts in rows", wave_mesh(3, 400, false));
  add("65535 vertices", strip(65535));
  add("65536 vertices", strip(65536));
  add("65537 vertices", strip(65537));
  return zoo;
}

}  // namespace pac::test
