// Diffuse interreflection among the faces of a mesh, gathered at its vertices for Gouraud shading.
//
// Form factors by casting rays over each face's cosine hemisphere (Malley's method: a row sums to at most 1 by
// construction and sees what is hidden); light that comes straight from emitters by shadow rays to points on them; the
// equation B_i = E_i + rho_i (D_i + sum_j F_ij (B_j - E_j)) solved by Gauss-Seidel to a residual; and one more gather
// at each vertex. Linear light throughout, color channels independent. Cohen and Wallace, Radiosity and Realistic Image
// Synthesis, 1993; Gershbein et al. 1994 for textured surfaces.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/mesh.h"
#include "sim/ray_caster.h"

namespace pac::sim {

// How light leaves a face.
struct FaceOptics {
  glm::vec3 reflectance{0.5f};  // mean over the face's texture, each channel in [0, 1)
  glm::vec3 emission{0.0f};     // radiosity that the front gives off by itself
  glm::vec3 sun{0.0f};          // irradiance from beyond the model that lands on the front
  bool thin = false;            // seen alike from both sides (cloth); otherwise a face's back is the inside of a solid
};

struct RadiosityOptions {
  int rays_per_face = 192;       // for its row of form factors
  int rays_per_vertex = 192;     // for its final gather, spread over the faces that meet there
  int samples_per_emitter = 48;  // shadow rays a receiver, shared among the emitters by their power
  float residual = 1e-4f;        // stop when no radiosity changes by more than this share of the largest
  int max_iterations = 100;
};

// Sparse rows: face i sees column[k] with form factor value[k], for k in [row[i], row[i + 1]).
struct FormFactors {
  std::vector<uint32_t> row, column;
  std::vector<float> value;

  float row_sum(size_t face) const;
  float between(size_t from, uint32_t to) const;  // 0 if not seen
};

FormFactors form_factors(const Mesh& mesh, const RayCaster& caster, const std::vector<FaceOptics>& optics,
                         int rays_per_face);

struct Radiosity {
  std::vector<glm::vec3> face_radiosity;     // what leaves each face
  std::vector<glm::vec3> vertex_irradiance;  // what arrives at each vertex, all bounces
  // Local lighting: straight from the emitters as if nothing stood between, no sun, plus one ambient term for the room,
  // the mean over all surfaces of what they reflect.
  std::vector<glm::vec3> vertex_local;
  int iterations = 0;
  float residual = 0;
};

// `optics` has one entry a face; faces are convex. Deterministic, the same on every machine.
Radiosity solve_radiosity(const Mesh& mesh, const std::vector<FaceOptics>& optics,
                          const RadiosityOptions& options = {});

}  // namespace pac::sim
