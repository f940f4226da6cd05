#include "raster/node_animation.h"

#include <algorithm>
#include <cmath>

#include "base/exact_math.h"

namespace pac::raster {
namespace {

// The angle in [0, pi/2] with that cosine, by bisection of the exact cosine, which falls there: base/exact_math.h has
// no arc cosine, and libm's digits vary.
double angle_of_cosine(double cosine) {
  double low = 0, high = kPi / 2;
  for (int i = 0; i < 52; ++i) {
    const double middle = 0.5 * (low + high);
    (exact_cos(middle) > cosine ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void normalize(double q[4]) {
  const double length = std::sqrt((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
  if (!(length > 1e-30) || !std::isfinite(length)) {
    q[0] = q[1] = q[2] = 0;
    q[3] = 1;
    return;
  }
  for (int i = 0; i < 4; ++i) q[i] /= length;
}

// Spherical linear interpolation along the shorter arc [glTF 2.0 appendix C.4].
void slerp(const float* from, const float* to, double t, double out[4]) {
  double a[4], b[4];
  std::copy_n(from, 4, a);
  std::copy_n(to, 4, b);
  normalize(a);
  normalize(b);
  double dot = (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
  const double sign = dot < 0 ? -1 : 1;
  dot = std::min(dot * sign, 1.0);
  double wa = 1 - t, wb = t;
  if (dot < 0.9999) {  // nearer ones differ from a straight line by less than float shows
    const double angle = angle_of_cosine(dot), sine = exact_sin(angle);
    wa = exact_sin(angle * (1 - t)) / sine;
    wb = exact_sin(angle * t) / sine;
  }
  for (int i = 0; i < 4; ++i) out[i] = wa * a[i] + sign * wb * b[i];
}

void sample(const Channel& channel, double time_s, double* out) {
  const size_t width = channel.width(), n = channel.times_s.size();
  const bool spline = channel.interpolation == Interpolation::cubic_spline;
  const size_t stride = spline ? 3 * width : width;
  const float* values = channel.values.data() + (spline ? width : 0);  // behind the first in-tangent
  const auto after = std::upper_bound(channel.times_s.begin(), channel.times_s.end(), time_s);
  const size_t next = static_cast<size_t>(after - channel.times_s.begin());
  if (next == 0 || next == n || channel.interpolation == Interpolation::step) {
    std::copy_n(values + stride * (next == 0 ? 0 : next - 1), width, out);
    return;
  }
  const double begin = channel.times_s[next - 1], span = channel.times_s[next] - begin;
  const double t = (time_s - begin) / span;
  const float *a = values + stride * (next - 1), *b = values + stride * next;
  if (spline) {  // Hermite [glTF 2.0 appendix C.5]
    const double t2 = t * t, t3 = t2 * t;
    const float *leaving = a + width, *arriving = b - width;
    for (size_t i = 0; i < width; ++i)
      out[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span * (t3 - 2 * t2 + t) * leaving[i] + (3 * t2 - 2 * t3) * b[i] +
               span * (t3 - t2) * arriving[i];
  } else if (channel.path == ChannelPath::rotation) {
    slerp(a, b, t, out);
  } else {
    for (size_t i = 0; i < width; ++i) out[i] = (1 - t) * a[i] + t * b[i];
  }
}

Affine local_transform(const AnimatedNode& node) {
  if (node.has_matrix) return node.matrix;
  double q[4];
  std::copy_n(node.rotation.data(), 4, q);
  normalize(q);
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                          {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                          {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
  Affine out;
  for (size_t column = 0; column < 3; ++column)
    for (size_t row = 0; row < 3; ++row) out.m[column][row] = r[column][row] * node.scale[column];
  for (size_t row = 0; row < 3; ++row) out.m[3][row] = node.translation[row];
  return out;
}

}  // namespace

Affine operator*(const Affine& a, const Affine& b) {
  Affine out;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) {
      double sum = (a.m[0][row] * b.m[column][0] + a.m[1][row] * b.m[column][1]) + a.m[2][row] * b.m[column][2];
      if (column == 3) sum += a.m[3][row];
      out.m[column][row] = sum;
    }
  return out;
}

glm::mat4 to_matrix(const Affine& a) {
  // pose_mesh() refuses what is larger than 2^60, a NaN included; such a transform draws nothing that could be seen.
  glm::mat4 out(1.0f);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) {
      const double value = a.m[column][row];
      if (!(std::fabs(value) <= 0x1p59)) return glm::mat4(1.0f);
      out[column][row] = static_cast<float>(value);
    }
  return out;
}

bool inverse(const Affine& a, Affine& out) {
  const auto& m = a.m;
  double cofactor[3][3];  // [row][column]
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
      cofactor[row][column] = m[c1][r1] * m[c2][r2] - m[c2][r1] * m[c1][r2];
    }
  const double determinant = (m[0][0] * cofactor[0][0] + m[1][0] * cofactor[0][1]) + m[2][0] * cofactor[0][2];
  if (!(std::fabs(determinant) > 1e-60) || !std::isfinite(determinant)) return false;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) out.m[column][row] = cofactor[column][row] / determinant;
  for (int row = 0; row < 3; ++row)
    out.m[3][row] = -((out.m[0][row] * m[3][0] + out.m[1][row] * m[3][1]) + out.m[2][row] * m[3][2]);
  for (const auto& column : out.m)
    for (const double value : column)
      if (!std::isfinite(value)) return false;
  return true;
}

std::vector<Affine> world_transforms(const NodeAnimation& animation, double time_s) {
  std::vector<AnimatedNode> nodes = animation.nodes;
  for (const Channel& channel : animation.channels) {
    AnimatedNode& node = nodes[channel.node];
    double* target = channel.path == ChannelPath::translation ? node.translation.data()
                     : channel.path == ChannelPath::rotation  ? node.rotation.data()
                                                              : node.scale.data();
    sample(channel, time_s, target);
  }
  std::vector<Affine> world(nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    const Affine local = local_transform(nodes[i]);
    world[i] = nodes[i].parent < 0 ? local : world[static_cast<size_t>(nodes[i].parent)] * local;
  }
  return world;
}

void pose_objects(const NodeAnimation& animation, double time_s, double previous_time_s, Scene& scene) {
  PAC_ASSERT(scene.objects.size() == animation.mounts.size());
  const auto wrapped = [&](double time) {
    if (!(time > 0)) return 0.0;
    if (!(animation.duration_s > 0) || time <= animation.duration_s) return time;
    return time - animation.duration_s * std::floor(time / animation.duration_s);
  };
  const std::vector<Affine> now = world_transforms(animation, wrapped(time_s));
  const std::vector<Affine> before = world_transforms(animation, wrapped(previous_time_s));
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const NodeAnimation::Mount& mount = animation.mounts[i];
    scene.objects[i].world_from_object = to_matrix(now[mount.node] * mount.node_from_object);
    scene.objects[i].previous_world_from_object = to_matrix(before[mount.node] * mount.node_from_object);
  }
}

}  // namespace pac::raster
