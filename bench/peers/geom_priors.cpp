// Trains geomcodec/priors.inc and geomcodec/detail_priors.inc: encodes generated meshes, untrained, reads where the
// decoder's models ended, and prints their means, weighted by what each has seen. Deterministic.
// usage: geom_priors > geomcodec/priors.inc             geom_priors --details > geomcodec/detail_priors.inc
//        geom_priors --faces > geomcodec/walk_priors.inc: from the symbols of the faces' walk, by tables
//        geom_priors --sizes: bytes with and without, on meshes not trained on
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "base/exact_math.h"
#include "base/mesh.h"
#include "geomcodec/color_coder.h"
#include "geomcodec/connectivity.h"
#include "geomcodec/container.h"
#include "geomcodec/geomcodec.h"
#include "geomcodec/position_coder.h"
#include "geomcodec/seams.h"

namespace {

using namespace pac::geomcodec;
using Point = std::array<double, 3>;

class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed * 2 + 1) {
    for (int i = 0; i < 4; ++i) unit();
  }
  double unit() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 40) / 16777216.0;
  }
  uint32_t below(uint32_t bound) { return static_cast<uint32_t>(unit() * bound); }

 private:
  uint64_t state_;
};

// A sum of a few waves.
struct Waves {
  explicit Waves(Random& random) {
    for (auto& wave : wave_) {
      wave = {0.25 * random.unit(), 1 + random.below(6) * 1.0, 1 + random.below(6) * 1.0, 6.28 * random.unit()};
      wave[0] /= wave[1] + wave[2];
    }
  }
  double at(double u, double v) const {
    double sum = 0;
    for (const auto& wave : wave_) sum += wave[0] * pac::exact_sin(6.283185 * (wave[1] * u + wave[2] * v) + wave[3]);
    return sum;
  }

 private:
  std::array<std::array<double, 4>, 4> wave_;
};

// Where the point (u, v) of a surface lies, by its kind: a rough ball, a bent tube, a landscape, a stepped plate.
Point on_surface(uint32_t kind, const Waves& waves, double u, double v) {
  const double a = 2 * pac::kPi * u, b = pac::kPi * v, w = waves.at(u, v);
  if (kind == 0) {
    const double r = 1 + w, s = pac::exact_sin(b);
    return {r * s * pac::exact_cos(a), r * s * pac::exact_sin(a), r * pac::exact_cos(b)};
  }
  if (kind == 1) {
    const double r = 0.3 + 0.5 * waves.at(0.1, v) + 0.2 * w;
    return {2 * v, 0.4 * pac::exact_sin(5 * v) + r * pac::exact_cos(a), r * pac::exact_sin(a)};
  }
  if (kind == 2) return {u, v, w};
  return {u, v, 0.1 * std::floor(8 * w) + 0.3 * std::floor(3 * u)};
}

pac::Mesh surface(uint64_t seed) {
  Random random(seed);
  const Waves waves(random);
  const uint32_t kind = random.below(4), columns = 8 + random.below(40), rows = 8 + random.below(40);
  const bool quads = random.below(4) == 0, closed = kind < 2;
  const int diagonals = static_cast<int>(random.below(3));  // all alike, alternating, by chance
  const double jitter = random.below(2) == 0 ? 0 : 0.6 * random.unit(), noise = random.below(3) == 0 ? 0.01 : 0;
  const uint32_t width = closed ? columns : columns + 1;
  pac::Mesh mesh;
  for (uint32_t y = 0; y <= rows; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const double u = (x + jitter * (random.unit() - 0.5)) / columns;
      const double v = (y + 0.5 + jitter * (random.unit() - 0.5)) / (rows + 1);
      const Point p = on_surface(kind, waves, u, v);
      pac::Vertex vertex;
      for (size_t i = 0; i < 3; ++i) vertex.position[i] = static_cast<float>(p[i] + noise * (random.unit() - 0.5));
      mesh.vertices.push_back(vertex);
    }
  }
  const auto add = [&](std::initializer_list<uint32_t> corners) {
    mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(corners.size()), 0});
    mesh.indices.insert(mesh.indices.end(), corners);
  };
  for (uint32_t y = 0; y < rows; ++y) {
    for (uint32_t x = 0; x < columns; ++x) {
      const uint32_t right = (x + 1) % width, a = y * width + x, b = y * width + right, c = b + width, d = a + width;
      const bool other = diagonals == 1 ? (x + y) % 2 == 1 : diagonals == 2 && random.below(2) == 1;
      if (quads) {
        add({a, b, c, d});
      } else if (other) {
        add({a, b, d});
        add({b, c, d});
      } else {
        add({a, b, c});
        add({a, c, d});
      }
    }
  }
  return mesh;
}

// A light, a sky and a slow pattern, from the normals of the faces.
void shade(pac::Mesh& mesh, uint64_t seed) {
  Random random(seed + 1000);
  const Point light = {random.unit() - 0.5, random.unit() - 0.5, 0.4 + 0.5 * random.unit()};
  const Point albedo = {0.4 + 0.5 * random.unit(), 0.4 + 0.5 * random.unit(), 0.4 + 0.5 * random.unit()};
  std::vector<Point> normal(mesh.vertices.size());
  for (const pac::Face& face : mesh.faces) {
    const uint32_t* corner = mesh.indices.data() + face.first;
    double u[3], w[3];
    for (size_t i = 0; i < 3; ++i) {
      const float here = mesh.vertices[corner[0]].position[i];
      u[i] = double{mesh.vertices[corner[1]].position[i]} - here;
      w[i] = double{mesh.vertices[corner[2]].position[i]} - here;
    }
    for (uint32_t k = 0; k < face.count; ++k)
      for (size_t i = 0; i < 3; ++i)
        normal[corner[k]][i] += u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
  }
  for (size_t v = 0; v < normal.size(); ++v) {
    const Point& n = normal[v];
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) + 1e-12;
    const double facing = std::max(0.0, (n[0] * light[0] + n[1] * light[1] + n[2] * light[2]) / length);
    const double sky = 0.5 + 0.5 * n[2] / length,
                 pattern = 0.9 + 0.1 * pac::exact_sin(4.0 * mesh.vertices[v].position[0]);
    for (size_t c = 0; c < 3; ++c)
      mesh.vertices[v].color[c] = static_cast<uint8_t>(
          255 * std::min(1.0, pattern * albedo[c] * (0.15 + facing + (0.1 + 0.05 * static_cast<double>(c)) * sky)));
    mesh.vertices[v].color[3] = 255;
  }
}

QuantizedMesh training_mesh(uint64_t seed) {
  constexpr int kBits[] = {11, 12, 14, 16};
  pac::Mesh mesh = surface(seed);
  shade(mesh, seed);
  return merge_equal_vertices(quantize(mesh, kBits[seed % 4]).value());
}

// Sums of what models ended with.
class Collected {
 public:
  template <size_t kOthers>
  void add(uint32_t set, const ClassModels<kOthers>& models) {
    for (size_t i = 0; i < 2 * kClasses; ++i) add(sums_[set][i], models.by_scale[i]);
    for (size_t i = 0; i < kOthers; ++i) add(sums_[set][2 * kClasses + i], models.by_other[i]);
  }
  void add_details(uint32_t set, const DetailModel& models) {
    for (uint32_t c = 1; c < kClasses; ++c) add(details_[set][c], models.of_class[c]);
  }
  void print(bool details) const {
    // A class has two signs and at most three bits below its leading one.
    const auto n_details = [](size_t c) { return size_t{1} << std::min<size_t>(c, 4); };
    if (details)
      for (const auto& set : details_) print_set(set, n_details);
    else
      for (const auto& set : sums_) print_set(set, [](size_t) { return size_t{SymbolModel::kSymbols}; });
  }

 private:
  static constexpr double kFewest = 40;  // symbols
  using Weights = std::array<double, SymbolModel::kSymbols>;
  static void add(Weights& sums, const SymbolModel& model) {
    const int seen = std::max(model.seen - kExpecting[0].seen, 0);
    for (size_t c = 0; c < SymbolModel::kSymbols; ++c) {
      const int end = c + 1 < SymbolModel::kSymbols ? model.start[c + 1] : SymbolModel::kTotal;
      const int size = end - model.start[c] - SymbolModel::kFloor;
      sums[c] += static_cast<double>(seen) * std::max(size, 0) / SymbolModel::kTotal;
    }
  }
  // n_used(i): symbols that context i has.
  template <size_t kCount, class Used>
  static void print_set(const std::array<Weights, kCount>& set, Used n_used) {
    std::printf("{");
    for (size_t i = 0; i < kCount; ++i) {
      const Weights& context = set[i];
      const double highest = *std::max_element(context.begin(), context.end());
      double total = 0;
      for (const double sum : context) total += sum;
      std::printf("{");
      for (size_t c = 0; c < context.size(); ++c) {
        const int weight =
            total < kFewest || c >= n_used(i) ? 0 : std::max(1, static_cast<int>(255 * context[c] / highest + 0.5));
        std::printf("%d%s", weight, c + 1 < context.size() ? "," : "");
      }
      std::printf("},\n");
    }
    std::printf("},\n");
  }

  std::array<std::array<Weights, kPriorContexts>, kPriorSets> sums_ = {};
  std::array<std::array<Weights, kClasses>, kDetailSets> details_ = {};
};

constexpr EncodeOptions kUntrained = {.trained_priors = false, .effort = Effort::best};

// Decodes positions and colors as vertices.cpp does and keeps the models. Meshes with seams are passed over.
void train(const QuantizedMesh& mesh, Collected& collected) {
  const std::vector<uint8_t> bytes = encode(mesh, kUntrained).value();
  const ParsedStream stream = parse_stream(bytes).value();
  const Header& header = stream.header;
  if (header.n_split_vertices > 0 || !header.has(kColors)) return;
  const Topology points =
      decode_connectivity(stream.section[kConnectivity], {header.n_points(), header.n_faces, header.n_corners}, false,
                          Expected::nothing, bytes.size())
          .value();
  const Seams seams = decode_seams({}, points, header.n_used_vertices).value();
  const Stencils stencils(points);
  RangeDecoder of_positions(stream.section[kPositions]), of_colors(stream.section[kColors]);
  PositionWeights weights;
  weights.chooses = header.chooses;
  code_weights(of_positions, weights);
  if (weights.raw) return;
  PositionCoder<RangeDecoder> position_coder(points, stencils, of_positions, weights, header.position_bits, false);
  const AttributeMesh attributes{points, stencils, seams.sibling};
  ColorCoder<RangeDecoder> color_coder(attributes, of_colors, false);
  std::vector<QuantizedVertex> vertices(header.n_vertices());
  std::vector<Position> positions(vertices.size());
  color_coder.begin(vertices);
  for (uint32_t v = 0; v < vertices.size(); ++v) {
    position_coder.code(v, positions);
    color_coder.code(v, vertices);
  }
  for (const auto& role : position_coder.models().classes)
    for (size_t basis = 0; basis < kBases; ++basis)
      collected.add(kPriorPositions + kPriorOfPositionBasis[basis], role[basis]);
  for (const DetailModel& details : position_coder.models().details)
    collected.add_details(kDetailsOfPositions, details);
  for (const size_t channel : {size_t{0}, size_t{1}, size_t{2}})
    for (const DetailModel& details : color_coder.models().channel[channel].details)
      collected.add_details(channel == 1 ? kDetailsOfGreen : kDetailsOfRedBlue, details);
  for (const size_t channel : {size_t{0}, size_t{1}, size_t{2}})
    for (size_t basis = 0; basis < kAttributeBases; ++basis)
      collected.add((channel == 1 ? kPriorGreen : kPriorRedBlue) + kPriorOfAttributeBasis[basis],
                    color_coder.models().channel[channel].classes[basis]);
}

// The faces without those of equal corners, `now` telling which vertex each vertex became.
void merge_vertices(pac::Mesh& mesh, const std::vector<uint32_t>& now) {
  std::vector<uint32_t> indices;
  std::vector<pac::Face> faces;
  for (const pac::Face& face : mesh.faces) {
    const uint32_t corner[3] = {now[mesh.indices[face.first]], now[mesh.indices[face.first + 1]],
                                now[mesh.indices[face.first + 2]]};
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
    faces.push_back({static_cast<uint32_t>(indices.size()), 3, 0});
    indices.insert(indices.end(), corner, corner + 3);
  }
  mesh.indices = std::move(indices);
  mesh.faces = std::move(faces);
}

// A mesh of triangles with edges drawn together until so many parts of 16 of its faces are gone, none at vertices that
// would have too many edges: what simplification leaves, and scans.
void simplify(pac::Mesh& mesh, uint32_t parts, Random& random) {
  const size_t wanted = mesh.faces.size() * (16 - parts) / 16;
  for (int round = 0; round < 40 && mesh.faces.size() > wanted; ++round) {
    std::vector<uint32_t> degree(mesh.vertices.size()), now(mesh.vertices.size());
    for (const uint32_t index : mesh.indices) ++degree[index];
    for (uint32_t v = 0; v < now.size(); ++v) now[v] = v;
    std::vector<uint8_t> near(mesh.vertices.size());  // to an edge drawn together in this round
    size_t left = mesh.faces.size();
    for (const pac::Face& face : mesh.faces) {
      const uint32_t* corner = mesh.indices.data() + face.first;
      const uint32_t k = random.below(24), a = corner[k % 3], b = corner[(k + 1) % 3];
      if (k >= 3 || left <= wanted || near[a] + near[b] > 0 || degree[a] + degree[b] > 12) continue;
      for (const pac::Face& other : mesh.faces) {
        const uint32_t* its = mesh.indices.data() + other.first;
        if (std::find(its, its + 3, a) != its + 3 || std::find(its, its + 3, b) != its + 3)
          for (int i = 0; i < 3; ++i) near[its[i]] = 1;
      }
      now[b] = a;
      left -= 2;
    }
    merge_vertices(mesh, now);
  }
}

// Without every n-th face or so.
void make_holes(pac::Mesh& mesh, uint32_t n, Random& random) {
  std::erase_if(mesh.faces, [&](const pac::Face& /*face*/) { return random.below(n) == 0; });
}

// Every n-th quadrilateral or so as two triangles.
void cut_some(pac::Mesh& mesh, uint32_t n, Random& random) {
  std::vector<pac::Face> faces;
  std::vector<uint32_t> indices;
  for (const pac::Face& face : mesh.faces) {
    const uint32_t* corner = mesh.indices.data() + face.first;
    const bool cut = face.count == 4 && random.below(n) == 0;
    const auto add = [&](std::initializer_list<uint32_t> corners) {
      faces.push_back({static_cast<uint32_t>(indices.size()), static_cast<uint32_t>(corners.size()), 0});
      indices.insert(indices.end(), corners);
    };
    if (cut || face.count == 3) add({corner[0], corner[1], corner[2]});
    if (cut) add({corner[0], corner[2], corner[3]});
    if (!cut && face.count == 4) add({corner[0], corner[1], corner[2], corner[3]});
  }
  mesh.faces = std::move(faces);
  mesh.indices = std::move(indices);
}

// The faces of a surface, simplified, cut, with holes, or as they are.
pac::Mesh training_faces(uint64_t seed) {
  Random random(seed + 2000);
  pac::Mesh mesh = surface(seed);
  if (mesh.faces[0].count == 3 && random.below(4) != 0) simplify(mesh, 2 + random.below(11), random);
  if (mesh.faces[0].count == 4 && random.below(2) == 0) cut_some(mesh, 2 + random.below(8), random);
  if (random.below(3) == 0) make_holes(mesh, 8 + random.below(80), random);
  return mesh;
}

// Symbols of the walk's contexts, those of any mesh counting a limited number of times: what occurs often gets a table
// of its own.
class WalkSymbols {
 public:
  void add(const pac::Mesh& mesh) {
    constexpr double kMost = 64;
    const auto counts = count_walk_symbols(mesh.indices, mesh.faces, static_cast<uint32_t>(mesh.vertices.size()));
    for (size_t context = 0; context < kWalkContexts; ++context) {
      double total = 0;
      for (const uint32_t count : counts[context]) total += count;
      for (size_t s = 0; s < kWalkSymbols; ++s)
        sums_[context][s] += counts[context][s] * (total > kMost ? kMost / total : 1.0);
    }
  }
  // A context is taken together with its likes of any second degree, and these with those of any first, which count as
  // a few symbols; where a mesh of the training never was, the row is theirs.
  void print() const {
    for (size_t context = 0; context < kWalkContexts; ++context) {
      const bool gate = context < kGates;
      const size_t place = gate ? context : context - kGates;
      const size_t inner = gate ? 8 : 2, outer = gate ? 480 : 72;  // contexts of one second degree, of all degrees
      const Weights of_place = together(context - place % outer + place % inner, inner, outer / inner);
      const Weights of_first = together(context - place % (6 * inner) + place % inner, inner, 6);
      Weights sums = {};
      for (size_t s = 0; s < (gate ? kWalkSymbols : 6); ++s) sums[s] = 1;
      for (const Weights& more : {of_place, of_first, sums_[context]}) sums = added(more, sums);
      const double highest = *std::max_element(sums.begin(), sums.end());
      std::printf("{");
      for (size_t s = 0; s < kWalkSymbols; ++s)
        std::printf("%d%s", static_cast<int>(255 * sums[s] / highest + 0.5), s + 1 < kWalkSymbols ? "," : "},\n");
    }
  }

 private:
  static constexpr double kFew = 8;
  static constexpr size_t kGates = 480;  // contexts of gates; the others are corners'
  using Weights = std::array<double, kWalkSymbols>;
  static double total(const Weights& sums) {
    double total = 0;
    for (const double sum : sums) total += sum;
    return total;
  }
  // What was met, and `like` as if it were so many symbols.
  static Weights added(Weights met, const Weights& like) {
    const double all = total(like), few = all > 0 ? kFew / all : 0;
    for (size_t s = 0; s < kWalkSymbols; ++s) met[s] += few * like[s];
    return met;
  }
  Weights together(size_t first, size_t step, size_t n) const {
    Weights sums = {};
    for (size_t i = 0; i < n; ++i)
      for (size_t s = 0; s < kWalkSymbols; ++s) sums[s] += sums_[first + i * step][s];
    return sums;
  }
  std::array<Weights, kWalkContexts> sums_ = {};
};

}  // namespace

int main(int argc, char** argv) {
  constexpr uint64_t kTraining = 96, kOthers = 24;
  if (argc > 1 && std::strcmp(argv[1], "--sizes") == 0) {
    for (uint64_t seed = kTraining; seed < kTraining + kOthers; ++seed) {
      const QuantizedMesh mesh = training_mesh(seed);
      const size_t with = encode(mesh, {.effort = Effort::best}).value().size();
      const size_t without = encode(mesh, kUntrained).value().size();
      std::printf("%6zu faces %7zu -> %7zu bytes, %.3f\n", mesh.faces.size(), without, with,
                  static_cast<double>(with) / static_cast<double>(without));
    }
    return 0;
  }
  if (argc > 1 && std::strcmp(argv[1], "--faces") == 0) {
    WalkSymbols symbols;
    for (uint64_t seed = 0; seed < kTraining; ++seed) symbols.add(training_faces(seed));
    symbols.print();
    return 0;
  }
  Collected collected;
  for (uint64_t seed = 0; seed < kTraining; ++seed) train(training_mesh(seed), collected);
  collected.print(argc > 1 && std::strcmp(argv[1], "--details") == 0);
  return 0;
}
