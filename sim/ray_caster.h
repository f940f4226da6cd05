// Rays against a polygon mesh, by a bounding volume hierarchy: what the radiosity solver sees with.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/mesh.h"

namespace pac::sim {

// Keeps its own copy of the triangles (each face a fan about its first corner: faces are convex). Same bits on every
// machine. const functions may be called from several threads at once.
class RayCaster {
 public:
  explicit RayCaster(const Mesh& mesh);  // valid mesh, finite positions

  struct Hit {
    float distance = 0;      // in lengths of the ray's direction
    uint32_t face = 0;       // index into Mesh::faces
    bool from_back = false;  // the ray came from behind the face
  };

  // The first face along origin + t * direction for t in (0, limit); false if there is none. Touching an edge counts.
  bool closest(const glm::vec3& origin, const glm::vec3& direction, float limit, Hit* hit) const;
  // Whether there is any.
  bool occluded(const glm::vec3& origin, const glm::vec3& direction, float limit) const;

 private:
  struct Triangle {
    glm::vec3 corner, edge1, edge2;
    uint32_t face;
  };
  // The children of an inner node (count 0) are at `first` and `right`; a leaf has `count` triangles from `first`.
  struct Node {
    glm::vec3 low, high;
    uint32_t first = 0, count = 0, right = 0;
    int axis = 0;  // the left child is the lower one along it
  };
  void build(uint32_t node, uint32_t first, uint32_t count);
  template <bool kAny>
  bool trace(const glm::vec3& origin, const glm::vec3& direction, float limit, Hit* hit) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace pac::sim
