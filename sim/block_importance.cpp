#include "sim/block_importance.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "raster/triangulate.h"
#include "sim/model_prediction.h"

namespace pac::sim {

namespace {

constexpr double kLeast = 1.0 / 16, kGreatest = 16;
constexpr float kCrease = 0.9F;    // cosine of the angle between two normals
constexpr float kNearness = 0.9F;  // of the farther of two pixels to the nearer one's
constexpr int kSide = 8;

// What pixels show.
struct Geometry {
  DepthImage depth;
  IdImage id;
  int width() const { return id.width(); }
  int height() const { return id.height(); }
};

// What neighboring pixels are to each other, by their ids and depths.
class EdgeTest {
 public:
  explicit EdgeTest(const raster::Scene& scene) : surfaces_(surfaces_of(scene)), normals_(1) {
    for (const Face& face : scene.mesh.faces) normals_.push_back(raster::face_normal(scene.mesh, face));
  }

  bool is_edge(uint32_t a, uint32_t b) const {
    if (a == b) return false;
    if (a == 0 || b == 0 || surfaces_[a] != surfaces_[b]) return true;
    const raster::FaceNormal &m = normals_[a], &n = normals_[b];
    const float lengths = std::sqrt((m.x * m.x + m.y * m.y + m.z * m.z) * (n.x * n.x + n.y * n.y + n.z * n.z));
    return m.x * n.x + m.y * n.y + m.z * n.z < kCrease * lengths;
  }
  // Depths are the window's: 1 less them falls as the inverse of distance, to 0 of the background.
  static bool is_silhouette(float a, float b) { return 1 - std::max(a, b) < kNearness * (1 - std::min(a, b)); }

 private:
  std::vector<uint32_t> surfaces_;           // by id
  std::vector<raster::FaceNormal> normals_;  // by id, of any length
};

Result<Geometry> draw_geometry(raster::Renderer& renderer, const raster::Scene& scene, const raster::Camera& camera,
                               raster::RenderQuality quality, int width, int height) {
  Geometry out{DepthImage(width, height), IdImage(width, height)};
  quality.samples = 1;
  quality.shading_samples = 0;
  quality.lighting = raster::Lighting::local;
  PAC_CHECK(renderer.render(scene, camera, quality, {{}, out.depth.view(), out.id.view()}));
  return out;
}

// Marks of both pixels of each pair of neighbors that an edge or a silhouette divides.
struct Marks {
  GrayImage edges, silhouettes;
};
Marks find_edges(const Geometry& geometry, const EdgeTest& test) {
  const int w = geometry.width(), h = geometry.height();
  Marks marks{GrayImage(w, h), GrayImage(w, h)};
  const auto compare = [&](int x, int y, int next_x, int next_y) {
    if (test.is_edge(*geometry.id.pixel(x, y), *geometry.id.pixel(next_x, next_y)))
      *marks.edges.pixel(x, y) = *marks.edges.pixel(next_x, next_y) = 255;
    if (test.is_silhouette(*geometry.depth.pixel(x, y), *geometry.depth.pixel(next_x, next_y)))
      *marks.silhouettes.pixel(x, y) = *marks.silhouettes.pixel(next_x, next_y) = 255;
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (x + 1 < w) compare(x, y, x + 1, y);
      if (y + 1 < h) compare(x, y, x, y + 1);
    }
  return marks;
}

GrayImage band_of(const Marks& marks) {
  const int w = marks.edges.width(), h = marks.edges.height();
  GrayImage band(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if ((*marks.edges.pixel(x, y) | *marks.silhouettes.pixel(x, y)) == 0) continue;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, h - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, w - 1); ++u) *band.pixel(u, v) = 255;
    }
  return band;
}

// Of a block's pixels.
struct Counts {
  int pixels = 0, textured = 0, specular = 0, edges = 0, silhouettes = 0;
  float worth = 0;  // sum
};

BlockClass class_of(const Counts& counts) {
  if (counts.silhouettes > 0) return BlockClass::silhouette;
  if (counts.edges > 0) return BlockClass::edge;
  if (2 * counts.specular > counts.pixels) return BlockClass::specular;
  return 2 * counts.textured > counts.pixels ? BlockClass::textured : BlockClass::flat;
}

bool has_texture(const raster::Scene& scene, const raster::Material& material) {
  return material.texture >= 0 && !scene.textures[static_cast<size_t>(material.texture)].empty();
}

bool has_highlights(const raster::Material& material) {
  return material.lit && std::max({material.specular.r, material.specular.g, material.specular.b}) > 0;
}

class BlockCounter {
 public:
  BlockCounter(const raster::Scene& scene, bool with_texture, const std::vector<float>& worth) : worth_(worth) {
    is_textured_.push_back(0);
    is_specular_.push_back(0);
    for (const Face& face : scene.mesh.faces) {
      const raster::Material& material = scene.materials[face.material];
      is_textured_.push_back(with_texture && has_texture(scene, material) ? 1 : 0);
      is_specular_.push_back(has_highlights(material) ? 1 : 0);
    }
  }

  Counts count(const Geometry& geometry, const Marks& marks, int left, int top) const {
    Counts counts;
    const int right = std::min(left + kSide, geometry.width()), bottom = std::min(top + kSide, geometry.height());
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const uint32_t id = *geometry.id.pixel(x, y);
        counts.pixels += 1;
        counts.textured += is_textured_[id];
        counts.specular += is_specular_[id];
        counts.edges += *marks.edges.pixel(x, y) != 0 ? 1 : 0;
        counts.silhouettes += *marks.silhouettes.pixel(x, y) != 0 ? 1 : 0;
        counts.worth += worth_.empty() ? 1.0F : worth_[id];
      }
    return counts;
  }

 private:
  std::vector<uint8_t> is_textured_, is_specular_;  // by id
  const std::vector<float>& worth_;
};

void scale_to_mean_1(std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  for (float& value : values)
    value = static_cast<float>(static_cast<double>(value) * static_cast<double>(values.size()) / sum);
}

}  // namespace

bool ImportanceOptions::is_on() const {
  return foreground.is_on() || std::ranges::any_of(of_class, [](double weight) { return weight != 1; });
}

Result<void> read_class_weights(std::string_view text, std::array<double, kBlockClasses>& of_class) {
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(item.size() + 1, text.size()));
    const size_t equals = std::min(item.find('='), item.size());
    const auto name = std::ranges::find(kBlockClassNames, item.substr(0, equals));
    if (name == kBlockClassNames.end()) return Failure{Error::bad_argument, 0, "no such class of blocks"};
    const std::string number(item.substr(std::min(equals + 1, item.size())));
    char* end = nullptr;
    const double weight = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != 0 || !(weight >= kLeast && weight <= kGreatest))
      return Failure{Error::bad_argument, 0, "the weight of a class of blocks is outside 1/16..16"};
    of_class[static_cast<size_t>(name - kBlockClassNames.begin())] = weight;
  }
  return {};
}

Result<BlockImportance> find_importance(raster::Renderer& renderer, const raster::Scene& scene,
                                        const raster::Camera& camera, const raster::RenderQuality& quality, int width,
                                        int height, const ImportanceOptions& options) {
  for (const double weight : options.of_class)
    if (!(weight >= kLeast && weight <= kGreatest))
      return Failure{Error::bad_argument, 0, "the weight of a class of blocks is outside 1/16..16"};
  PAC_TRY(const std::vector<float> worth, worth_of_ids(scene, options.foreground));
  PAC_TRY(const Geometry geometry, draw_geometry(renderer, scene, camera, quality, width, height));
  const Marks marks = find_edges(geometry, EdgeTest(scene));
  const BlockCounter counter(scene, quality.texture, worth);
  BlockImportance out;
  for (int top = 0; top < geometry.height(); top += kSide)
    for (int left = 0; left < geometry.width(); left += kSide) {
      const Counts counts = counter.count(geometry, marks, left, top);
      out.classes.push_back(class_of(counts));
      if (!options.is_on()) continue;
      const auto weight = static_cast<float>(options.of_class[static_cast<size_t>(out.classes.back())]);
      out.importance.push_back(weight * counts.worth / static_cast<float>(counts.pixels));
    }
  scale_to_mean_1(out.importance);
  out.edge_band = band_of(marks);
  return out;
}

}  // namespace pac::sim
