#include "sim/radiosity.h"

#include <glm/glm.hpp>

#include "base/exact_math.h"

namespace pac::sim {

namespace {

constexpr float kLift = 1e-3f;  // rays start this far above their surface (metres)
constexpr float kFar = 1e30f;

glm::vec3 vertex_position(const Mesh& mesh, uint32_t vertex) {
  const float* p = mesh.vertices[vertex].position;
  return {p[0], p[1], p[2]};
}

glm::vec3 vertex_normal(const Mesh& mesh, uint32_t vertex) {
  const float* n = mesh.vertices[vertex].normal;
  return {n[0], n[1], n[2]};
}

struct FaceShape {
  glm::vec3 corners[4];  // a triangle repeats its last; of larger polygons the bounding fan's quad about the center
  glm::vec3 center, normal;
  float area = 0;
};

FaceShape face_shape(const Mesh& mesh, const Face& face) {
  FaceShape shape;
  shape.center = glm::vec3(0.0f);
  glm::vec3 twice_area(0.0f);
  const glm::vec3 first = vertex_position(mesh, mesh.indices[face.first]);
  for (uint32_t k = 0; k < face.count; ++k) {
    const glm::vec3 p = vertex_position(mesh, mesh.indices[face.first + k]);
    shape.center += p;
    if (k + 1 < face.count && k > 0)
      twice_area += glm::cross(p - first, vertex_position(mesh, mesh.indices[face.first + k + 1]) - first);
    if (k < 4) shape.corners[k] = p;
  }
  if (face.count == 3) shape.corners[3] = shape.corners[2];
  shape.center /= static_cast<float>(face.count);
  const float length = glm::length(twice_area);
  shape.normal = length > 0.0f ? twice_area / length : glm::vec3(0, 1, 0);
  shape.area = 0.5f * length;
  return shape;
}

glm::vec3 point_on(const FaceShape& shape, float s, float t) {
  const glm::vec3 low = shape.corners[0] + (shape.corners[1] - shape.corners[0]) * s;
  const glm::vec3 high = shape.corners[3] + (shape.corners[2] - shape.corners[3]) * s;
  return low + (high - low) * t;
}

// The n-th point of the additive recurrence on the golden ratio's generalization to 4 dimensions: evenly spread.
glm::vec4 spread_point(int n) {
  constexpr double kStep[4] = {0.8566748838545029, 0.7338918566271260, 0.6287067210378087, 0.5385972572236101};
  glm::vec4 point;
  for (int c = 0; c < 4; ++c) {
    const double x = 0.5 + kStep[c] * (n + 1);
    point[c] = static_cast<float>(x - std::floor(x));
  }
  return point;
}

// Directions over the z hemisphere, density cos / pi, each with a place on the unit square to start from.
struct HemisphereRay {
  glm::vec3 direction;
  float s, t;
};

std::vector<HemisphereRay> hemisphere_rays(int n) {
  std::vector<HemisphereRay> rays;
  for (int i = 0; i < n; ++i) {
    const glm::vec4 p = spread_point(i);
    const double radius = std::sqrt(static_cast<double>(p.x)), angle = 2.0 * kPi * static_cast<double>(p.y);
    const double z = std::sqrt(1.0 - static_cast<double>(p.x));
    rays.push_back({{static_cast<float>(radius * exact_cos(angle)), static_cast<float>(radius * exact_sin(angle)),
                     static_cast<float>(z)},
                    p.z,
                    p.w});
  }
  return rays;
}

struct TangentFrame {
  glm::vec3 x, y, z;
  explicit TangentFrame(const glm::vec3& normal) : z(normal) {
    const glm::vec3 other = std::fabs(normal.x) < 0.6f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    x = glm::normalize(glm::cross(other, normal));
    y = glm::cross(normal, x);
  }
  glm::vec3 operator()(const glm::vec3& d) const { return x * d.x + y * d.y + z * d.z; }
};

// A point that gives off light: a small part of an emitting face.
struct EmitterPoint {
  glm::vec3 position, normal, radiosity;
  float area;
};

float brightness(const glm::vec3& color) {
  return 0.2126f * color.x + 0.7152f * color.y + 0.0722f * color.z;
}

// Spreads about n_samples points over the emitting faces, by power, at least one each.
std::vector<EmitterPoint> emitter_points(const std::vector<FaceShape>& shapes, const std::vector<FaceOptics>& optics,
                                         int n_samples) {
  float power = 0.0f;
  for (size_t i = 0; i < shapes.size(); ++i) power += shapes[i].area * brightness(optics[i].emission);
  std::vector<EmitterPoint> points;
  if (!(power > 0.0f)) return points;
  for (size_t i = 0; i < shapes.size(); ++i) {
    const float share = shapes[i].area * brightness(optics[i].emission) / power;
    if (!(share > 0.0f)) continue;
    const int n = std::max(1, static_cast<int>(share * static_cast<float>(n_samples) + 0.5f));
    for (int k = 0; k < n; ++k) {
      const glm::vec4 at = spread_point(k);
      points.push_back({point_on(shapes[i], n == 1 ? 0.5f : at.x, n == 1 ? 0.5f : at.y), shapes[i].normal,
                        optics[i].emission, shapes[i].area / static_cast<float>(n)});
    }
  }
  return points;
}

// Irradiance at a point from the emitters; each point as a small disk, so that near ones stay finite.
glm::vec3 direct_light(const std::vector<EmitterPoint>& emitters, const RayCaster* caster, const glm::vec3& position,
                       const glm::vec3& normal) {
  glm::vec3 sum(0.0f);
  for (const EmitterPoint& emitter : emitters) {
    const glm::vec3 to = emitter.position - position;
    const float squared = glm::dot(to, to);
    const float here = glm::dot(to, normal), there = -glm::dot(to, emitter.normal);
    if (!(here > 0.0f && there > 0.0f)) continue;
    const float factor = here * there / squared * emitter.area / (static_cast<float>(kPi) * squared + emitter.area);
    if (caster != nullptr && caster->occluded(position, to, 0.999f)) continue;
    sum += emitter.radiosity * factor;
  }
  return sum;
}

// Where the light that reaches a vertex is sampled: in each face that meets there, a little way towards its center, so
// that a vertex on a wall or inside a solid still has samples in the open; half way, where none of those is.
class Gatherer {
 public:
  Gatherer(const Mesh& mesh, const std::vector<FaceOptics>& optics, const std::vector<FaceShape>& shapes,
           const RayCaster& caster, const std::vector<EmitterPoint>& emitters, int n_rays)
      : mesh_(mesh),
        optics_(optics),
        shapes_(shapes),
        caster_(caster),
        emitters_(emitters),
        rays_(hemisphere_rays(n_rays)),
        faces_of_(mesh.vertices.size()) {
    for (uint32_t f = 0; f < mesh.faces.size(); ++f)
      for (uint32_t k = 0; k < mesh.faces[f].count; ++k) faces_of_[mesh.indices[mesh.faces[f].first + k]].push_back(f);
  }

  // Mean irradiance over the vertex's faces at points that are `toward_center` of the way from it to their centers.
  // False if all these points are inside solids. The rays are dealt out to the points in turn.
  bool at_vertex(uint32_t vertex, float toward_center, const std::vector<glm::vec3>& reflected,
                 glm::vec3* irradiance) const {
    const glm::vec3 normal = vertex_normal(mesh_, vertex), corner = vertex_position(mesh_, vertex);
    const TangentFrame frame(normal);
    const std::vector<uint32_t>& faces = faces_of_[vertex];
    glm::vec3 sum(0.0f);
    int n_open = 0;
    for (size_t p = 0; p < faces.size(); ++p) {
      const glm::vec3 position = corner + (shapes_[faces[p]].center - corner) * toward_center + normal * kLift;
      glm::vec3 indirect(0.0f);
      int n_rays = 0, n_inside = 0;
      for (size_t r = p; r < rays_.size(); r += faces.size()) {
        ++n_rays;
        RayCaster::Hit hit;
        if (!caster_.closest(position, frame(rays_[r].direction), kFar, &hit)) continue;
        if (hit.from_back && !optics_[hit.face].thin) {
          ++n_inside;
        } else {
          indirect += reflected[hit.face];
        }
      }
      if (n_rays == 0 || n_inside * 4 > n_rays) continue;  // this point is inside a solid
      sum += indirect / static_cast<float>(n_rays) + direct_light(emitters_, &caster_, position, normal);
      ++n_open;
    }
    if (n_open > 0) *irradiance = sum / static_cast<float>(n_open);
    return n_open > 0;
  }

 private:
  const Mesh& mesh_;
  const std::vector<FaceOptics>& optics_;
  const std::vector<FaceShape>& shapes_;
  const RayCaster& caster_;
  const std::vector<EmitterPoint>& emitters_;
  std::vector<HemisphereRay> rays_;
  std::vector<std::vector<uint32_t>> faces_of_;
};

// Gives vertices that lie inside solids (known[v] == 0) the mean of their neighbours, ring by ring.
void fill_unknown(const Mesh& mesh, std::vector<uint8_t> known, std::vector<glm::vec3>* values) {
  for (int pass = 0; pass < 64; ++pass) {
    std::vector<glm::vec3> sum(values->size(), glm::vec3(0.0f));
    std::vector<int> count(values->size(), 0);
    for (const Face& face : mesh.faces) {
      for (uint32_t k = 0; k < face.count; ++k) {
        const uint32_t a = mesh.indices[face.first + k], b = mesh.indices[face.first + (k + 1) % face.count];
        if (known[a] == 0 && known[b] != 0) sum[a] += (*values)[b], ++count[a];
        if (known[b] == 0 && known[a] != 0) sum[b] += (*values)[a], ++count[b];
      }
    }
    bool changed = false;
    for (size_t v = 0; v < values->size(); ++v) {
      if (count[v] == 0) continue;
      (*values)[v] = sum[v] / static_cast<float>(count[v]);
      known[v] = 1;
      changed = true;
    }
    if (!changed) return;
  }
}

}  // namespace

float FormFactors::row_sum(size_t face) const {
  float sum = 0.0f;
  for (uint32_t k = row[face]; k < row[face + 1]; ++k) sum += value[k];
  return sum;
}

float FormFactors::between(size_t from, uint32_t to) const {
  for (uint32_t k = row[from]; k < row[from + 1]; ++k)
    if (column[k] == to) return value[k];
  return 0.0f;
}

FormFactors form_factors(const Mesh& mesh, const RayCaster& caster, const std::vector<FaceOptics>& optics,
                         int rays_per_face) {
  const std::vector<HemisphereRay> rays = hemisphere_rays(rays_per_face);
  FormFactors factors;
  factors.row.push_back(0);
  std::vector<int> hits(mesh.faces.size(), 0);
  std::vector<uint32_t> seen;
  for (const Face& face : mesh.faces) {
    const FaceShape shape = face_shape(mesh, face);
    const TangentFrame frame(shape.normal);
    for (const HemisphereRay& ray : rays) {
      RayCaster::Hit hit;
      const glm::vec3 start = point_on(shape, ray.s, ray.t) + shape.normal * kLift;
      if (!caster.closest(start, frame(ray.direction), kFar, &hit)) continue;
      if (hit.from_back && !optics[hit.face].thin) continue;
      if (hits[hit.face]++ == 0) seen.push_back(hit.face);
    }
    for (const uint32_t other : seen) {
      factors.column.push_back(other);
      factors.value.push_back(static_cast<float>(hits[other]) / static_cast<float>(rays_per_face));
      hits[other] = 0;
    }
    seen.clear();
    factors.row.push_back(static_cast<uint32_t>(factors.column.size()));
  }
  return factors;
}

namespace {

// Solves for what leaves each face beyond its own emission, given what arrives from emitters and sun.
void iterate(const FormFactors& factors, const std::vector<FaceOptics>& optics, const std::vector<glm::vec3>& direct,
             const RadiosityOptions& options, Radiosity* result, std::vector<glm::vec3>* reflected) {
  reflected->assign(optics.size(), glm::vec3(0.0f));
  for (result->iterations = 0; result->iterations < options.max_iterations; ++result->iterations) {
    float change = 0.0f, largest = 1e-20f;
    for (size_t i = 0; i < optics.size(); ++i) {
      glm::vec3 arriving = direct[i];
      for (uint32_t k = factors.row[i]; k < factors.row[i + 1]; ++k)
        arriving += (*reflected)[factors.column[k]] * factors.value[k];
      const glm::vec3 leaving = optics[i].reflectance * arriving;
      const glm::vec3 difference = glm::abs(leaving - (*reflected)[i]);
      change = std::max(change, std::max(difference.x, std::max(difference.y, difference.z)));
      largest = std::max(largest, std::max(leaving.x, std::max(leaving.y, leaving.z)));
      (*reflected)[i] = leaving;
    }
    result->residual = change / largest;
    if (result->residual < options.residual) return;
  }
}

void gather(const Mesh& mesh, const Gatherer& gatherer, const std::vector<glm::vec3>& reflected,
            const std::vector<EmitterPoint>& emitters, Radiosity* result) {
  const size_t n_vertices = mesh.vertices.size();
  result->vertex_irradiance.assign(n_vertices, glm::vec3(0.0f));
  result->vertex_local.assign(n_vertices, glm::vec3(0.0f));
  std::vector<uint8_t> known(n_vertices, 0);
  for (uint32_t v = 0; v < n_vertices; ++v) {
    constexpr float kNear = 0.14f, kHalfWay = 0.5f;
    glm::vec3* irradiance = &result->vertex_irradiance[v];
    known[v] =
        gatherer.at_vertex(v, kNear, reflected, irradiance) || gatherer.at_vertex(v, kHalfWay, reflected, irradiance);
    const glm::vec3 normal = vertex_normal(mesh, v);
    result->vertex_local[v] = direct_light(emitters, nullptr, vertex_position(mesh, v) + normal * kLift, normal);
  }
  fill_unknown(mesh, std::move(known), &result->vertex_irradiance);
}

glm::vec3 mean_reflected(const std::vector<FaceShape>& shapes, const std::vector<glm::vec3>& reflected) {
  glm::vec3 sum(0.0f);
  float area = 0.0f;
  for (size_t i = 0; i < shapes.size(); ++i) {
    sum += reflected[i] * shapes[i].area;
    area += shapes[i].area;
  }
  return area > 0.0f ? sum / area : sum;
}

}  // namespace

Radiosity solve_radiosity(const Mesh& mesh, const std::vector<FaceOptics>& optics, const RadiosityOptions& options) {
  PAC_ASSERT(optics.size() == mesh.faces.size());
  const RayCaster caster(mesh);
  std::vector<FaceShape> shapes;
  for (const Face& face : mesh.faces) shapes.push_back(face_shape(mesh, face));
  const std::vector<EmitterPoint> emitters = emitter_points(shapes, optics, options.samples_per_emitter);

  std::vector<glm::vec3> direct;
  for (size_t i = 0; i < shapes.size(); ++i)
    direct.push_back(optics[i].sun +
                     direct_light(emitters, &caster, shapes[i].center + shapes[i].normal * kLift, shapes[i].normal));
  Radiosity result;
  std::vector<glm::vec3> reflected;
  iterate(form_factors(mesh, caster, optics, options.rays_per_face), optics, direct, options, &result, &reflected);
  for (size_t i = 0; i < optics.size(); ++i) result.face_radiosity.push_back(reflected[i] + optics[i].emission);

  gather(mesh, Gatherer(mesh, optics, shapes, caster, emitters, options.rays_per_vertex), reflected, emitters, &result);
  const glm::vec3 ambient = mean_reflected(shapes, reflected);
  for (glm::vec3& local : result.vertex_local) local += ambient;
  // Sunlit faces have vertices of their own (their outlines are the shadow's edges), so the sun adds at those.
  std::vector<uint8_t> sunny(mesh.vertices.size(), 0);
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    for (uint32_t k = 0; k < mesh.faces[f].count; ++k) {
      const uint32_t vertex = mesh.indices[mesh.faces[f].first + k];
      if (sunny[vertex] == 0) result.vertex_irradiance[vertex] += optics[f].sun;
      sunny[vertex] = 1;
    }
  }
  return result;
}

}  // namespace pac::sim
