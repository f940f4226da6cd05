#include "raster/load_normals.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pac::raster {
namespace {

using Vector = std::array<double, 3>;

constexpr double kCreaseCosine = 0.5;      // cos 60 degrees
constexpr size_t kMaxCreaseCorners = 256;  // at one position: the comparison of all pairs stays cheap

double dot(const Vector& a, const Vector& b) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

// Twice the polygon's area along its normal, about its first corner (huge offsets would cost digits).
Vector newell(std::span<const float> positions, std::span<const uint32_t> corners) {
  Vector sum = {0, 0, 0};
  const float* origin = &positions[size_t{3} * corners[0]];
  for (size_t k = 1; k + 1 < corners.size(); ++k) {
    Vector a, b;
    for (size_t axis = 0; axis < 3; ++axis) {
      a[axis] = double{positions[size_t{3} * corners[k] + axis]} - origin[axis];
      b[axis] = double{positions[size_t{3} * corners[k + 1] + axis]} - origin[axis];
    }
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
      sum[axis] += a[next] * b[last] - a[last] * b[next];
    }
  }
  return sum;
}

// Corners grouped by position.
struct Around {
  std::vector<uint32_t> first;   // n_positions + 1
  std::vector<uint32_t> corner;  // those at position p: corner[first[p]] .. corner[first[p + 1] - 1]
};

Around group_by_position(size_t n_positions, std::span<const uint32_t> corner_position) {
  Around around;
  around.first.assign(n_positions + 1, 0);
  for (const uint32_t position : corner_position) ++around.first[position + 1];
  for (size_t p = 0; p < n_positions; ++p) around.first[p + 1] += around.first[p];
  around.corner.resize(corner_position.size());
  std::vector<uint32_t> end(around.first.begin(), around.first.end() - 1);
  for (uint32_t c = 0; c < corner_position.size(); ++c) around.corner[end[corner_position[c]]++] = c;
  return around;
}

void store_unit(const Vector& sum, float* normal) {
  // Scaled first: squares of areas may leave the range of double.
  const double largest = std::max({std::fabs(sum[0]), std::fabs(sum[1]), std::fabs(sum[2])});
  if (!(largest > 0) || !std::isfinite(largest)) return;
  const Vector scaled = {sum[0] / largest, sum[1] / largest, sum[2] / largest};
  const double length = std::sqrt(dot(scaled, scaled));
  for (size_t axis = 0; axis < 3; ++axis) normal[axis] = static_cast<float>(scaled[axis] / length);
}

class Smoother {
 public:
  Smoother(std::span<const float> positions, std::span<const uint32_t> corner_position,
           std::span<const SmoothFace> faces, bool has_groups)
      : faces_(faces), has_groups_(has_groups) {
    corner_face_.resize(corner_position.size());
    for (uint32_t f = 0; f < faces.size(); ++f) {
      face_normal_.push_back(newell(positions, corner_position.subspan(faces[f].first, faces[f].count)));
      Vector unit = {0, 0, 0};
      float stored[3] = {0, 0, 0};
      store_unit(face_normal_[f], stored);
      for (size_t axis = 0; axis < 3; ++axis) unit[axis] = stored[axis];
      face_unit_.push_back(unit);
      for (uint32_t k = 0; k < faces[f].count; ++k) corner_face_[faces[f].first + k] = f;
    }
  }

  // The normals of all corners at one position.
  void at_position(std::span<const uint32_t> corners, std::vector<float>& normals) const {
    if (has_groups_) return by_group(corners, normals);
    Vector everyone = {0, 0, 0};
    const bool compare = corners.size() <= kMaxCreaseCorners;
    if (!compare)
      for (const uint32_t corner : corners) add(corner_face_[corner], everyone);
    for (const uint32_t corner : corners) {
      Vector sum = everyone;
      const Vector& own = face_unit_[corner_face_[corner]];
      const bool has_own = dot(own, own) > 0;
      for (const uint32_t other : corners)
        if (compare && (!has_own || dot(own, face_unit_[corner_face_[other]]) > kCreaseCosine))
          add(corner_face_[other], sum);
      store_unit(sum, &normals[size_t{3} * corner]);
    }
  }

 private:
  void add(uint32_t face, Vector& sum) const {
    for (size_t axis = 0; axis < 3; ++axis) sum[axis] += face_normal_[face][axis];
  }

  void by_group(std::span<const uint32_t> corners, std::vector<float>& normals) const {
    std::vector<uint32_t> sorted(corners.begin(), corners.end());
    const auto group = [&](uint32_t corner) { return faces_[corner_face_[corner]].smoothing_group; };
    std::stable_sort(sorted.begin(), sorted.end(), [&](uint32_t a, uint32_t b) { return group(a) < group(b); });
    for (size_t begin = 0; begin < sorted.size();) {
      size_t end = begin + 1;
      while (end < sorted.size() && group(sorted[begin]) != 0 && group(sorted[end]) == group(sorted[begin])) ++end;
      Vector sum = {0, 0, 0};
      for (size_t i = begin; i < end; ++i) add(corner_face_[sorted[i]], sum);
      for (size_t i = begin; i < end; ++i) store_unit(sum, &normals[size_t{3} * sorted[i]]);
      begin = end;
    }
  }

  std::span<const SmoothFace> faces_;
  const bool has_groups_;
  std::vector<Vector> face_normal_, face_unit_;
  std::vector<uint32_t> corner_face_;
};

}  // namespace

std::vector<float> smooth_normals(std::span<const float> positions, std::span<const uint32_t> corner_position,
                                  std::span<const SmoothFace> faces, bool has_smoothing_groups) {
  const Smoother smoother(positions, corner_position, faces, has_smoothing_groups);
  const Around around = group_by_position(positions.size() / 3, corner_position);
  std::vector<float> normals(3 * corner_position.size(), 0.0f);
  for (size_t p = 0; p + 1 < around.first.size(); ++p)
    smoother.at_position(std::span(around.corner).subspan(around.first[p], around.first[p + 1] - around.first[p]),
                         normals);
  return normals;
}

}  // namespace pac::raster
