// A hierarchy of nodes whose transforms change with time, and the objects of a scene that hang on them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raster/scene.h"

namespace pac::raster {

// Columns of an affine transform, last row 0 0 0 1, in double precision: chains of nodes are rounded to float once.
struct Affine {
  double m[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};  // [column][row]
};
Affine operator*(const Affine& a, const Affine& b);
glm::mat4 to_matrix(const Affine& a);

struct AnimatedNode {
  int32_t parent = -1;  // smaller than its own number, so that one pass computes all; -1 = the world's
  bool has_matrix = false;
  Affine matrix;  // where has_matrix; else translation * rotation * scale
  std::array<double, 3> translation{0, 0, 0};
  std::array<double, 4> rotation{0, 0, 0, 1};  // quaternion x y z w, any length but 0
  std::array<double, 3> scale{1, 1, 1};
};

enum class ChannelPath : uint8_t { translation, rotation, scale };
enum class Interpolation : uint8_t { step, linear, cubic_spline };

// One property of one node over time [glTF 2.0 s.3.11, appendix C].
struct Channel {
  uint32_t node = 0;
  ChannelPath path = ChannelPath::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times_s;  // strictly increasing, >= 1
  // width() floats a time; cubic_spline: in-tangent, value, out-tangent, so three times as many.
  std::vector<float> values;
  size_t width() const { return path == ChannelPath::rotation ? 4 : 3; }
};

struct NodeAnimation {
  std::vector<AnimatedNode> nodes;
  std::vector<Channel> channels;
  // Parallel to Scene::objects: which node moves it, and what its vertices' coordinates are seen from that node. Where
  // the node's first pose can be undone they are those of the world at time 0 (so that the mesh itself is the scene at
  // time 0), else the node's own.
  struct Mount {
    uint32_t node = 0;
    Affine node_from_object;
  };
  std::vector<Mount> mounts;
  double duration_s = 0;  // the last time of any channel

  bool empty() const { return channels.empty() || mounts.empty(); }
};

// World from node for every node at that time; before a channel's first and after its last time it stands still.
std::vector<Affine> world_transforms(const NodeAnimation& animation, double time_s);

// Sets the transforms of scene.objects (parallel to animation.mounts) to those at `time_s`, their previous ones to
// those at `previous_time_s`. Times beyond the duration start again; those below 0 are 0.
void pose_objects(const NodeAnimation& animation, double time_s, double previous_time_s, Scene& scene);

// The inverse; false where the volume vanishes (or anything is not finite).
bool inverse(const Affine& a, Affine& out);

}  // namespace pac::raster
