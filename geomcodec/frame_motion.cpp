// Motions between frames: from matrices, applied, and found from what moved. FORMAT.md section 14.
#include "geomcodec/frame_motion.h"

#include <algorithm>
#include <cmath>

#include "geomcodec/frame_stream.h"
#include "geomcodec/prediction.h"

namespace pac::geomcodec {
namespace {

using Matrix = double[4][4];

// Positions n of a grid of so many bits as -1 .. 1.
Grid unit_grid(int bits) {
  Grid grid;
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = -1;
    grid.step[axis] = std::ldexp(1.0f, 1 - bits);
  }
  return grid;
}

bool is_usable(const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(grid.origin[axis]) || !std::isfinite(grid.step[axis]) || !(grid.step[axis] > 0)) return false;
  return true;
}

// Least squares for the 15 numbers of a projective map (its last one is 1): per vertex and axis
// row(axis) . p - x(axis) * row(3) . p = x(axis), weighted.
class ProjectiveFit {
 public:
  static constexpr size_t kUnknowns = 15;
  using Row = std::array<double, kUnknowns + 1>;

  void add(const double (&p)[3], const double (&x)[3], double weight) {
    weight_ += weight;
    for (size_t axis = 0; axis < 3; ++axis) {
      Row equation{};
      for (size_t j = 0; j < 3; ++j) {
        equation[4 * axis + j] = p[j];
        equation[12 + j] = -x[axis] * p[j];
      }
      equation[4 * axis + 3] = 1;
      equation[kUnknowns] = x[axis];
      for (size_t i = 0; i < kUnknowns; ++i) {
        if (equation[i] == 0) continue;
        for (size_t j = 0; j <= kUnknowns; ++j) normal_[i][j] += weight * equation[i] * equation[j];
      }
    }
  }
  // False if the vertices do not tell. A little of the identity makes flat and thin meshes solvable.
  bool solve(Matrix& matrix) {
    const double regular = 1e-7 * weight_ + 1e-12;
    for (size_t i = 0; i < kUnknowns; ++i) {
      normal_[i][i] += regular;
      if (i < 12 && i % 4 == i / 4) normal_[i][kUnknowns] += regular;
    }
    for (size_t i = 0; i < kUnknowns; ++i)
      if (!eliminate(i)) return false;
    for (size_t i = 0; i < kUnknowns; ++i) matrix[i / 4][i % 4] = normal_[i][kUnknowns] / normal_[i][i];
    matrix[3][3] = 1;
    return true;
  }

 private:
  bool eliminate(size_t column) {
    size_t pivot = column;
    for (size_t i = column + 1; i < kUnknowns; ++i)
      if (std::abs(normal_[i][column]) > std::abs(normal_[pivot][column])) pivot = i;
    if (!(std::abs(normal_[pivot][column]) > 1e-14)) return false;
    std::swap(normal_[pivot], normal_[column]);
    for (size_t i = 0; i < kUnknowns; ++i) {
      if (i == column) continue;
      const double factor = normal_[i][column] / normal_[column][column];
      for (size_t j = column; j <= kUnknowns; ++j) normal_[i][j] -= factor * normal_[column][j];
    }
    return true;
  }
  std::array<Row, kUnknowns> normal_ = {};
  double weight_ = 0;
};

void to_unit(const Position& position, const Grid& grid, double (&out)[3]) {
  for (size_t axis = 0; axis < 3; ++axis)
    out[axis] = double{grid.origin[axis]} + double{grid.step[axis]} * position[axis];
}

// By how much a map misses, summed over the axes.
double miss_of(const Matrix& matrix, const double (&p)[3], const double (&x)[3]) {
  double at[4];
  for (int i = 0; i < 4; ++i) at[i] = matrix[i][0] * p[0] + matrix[i][1] * p[1] + matrix[i][2] * p[2] + matrix[i][3];
  if (!(at[3] > 1e-6)) return 1;
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) sum += std::abs(at[axis] / at[3] - x[axis]);
  return sum;
}

}  // namespace

Result<FrameMotion> frame_motion(const double (&matrix)[4][4], const Grid& from, const Grid& to) {
  if (!is_usable(from) || !is_usable(to)) return Failure{Error::bad_argument, 0, "grid is not finite or has no step"};
  double a[4][4];
  for (int i = 0; i < 4; ++i) {
    a[i][3] = matrix[i][3];
    for (int j = 0; j < 3; ++j) {
      a[i][j] = matrix[i][j] * double{from.step[j]};
      a[i][3] += matrix[i][j] * double{from.origin[j]};
    }
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) a[i][j] = (a[i][j] - double{to.origin[i]} * a[3][j]) / double{to.step[i]};
  // The greatest power of two that keeps all within 2^41 (slopes) and 2^57 (offsets), rounding included.
  int power = 1000;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (!std::isfinite(a[i][j])) return Failure{Error::bad_argument, 0, "motion is not finite"};
      int exponent = 0;
      std::frexp(a[i][j], &exponent);
      if (a[i][j] != 0) power = std::min(power, (j < 3 ? 41 : 57) - exponent);
    }
  }
  FrameMotion motion;
  bool divides = false;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      motion.row[i][j] = static_cast<int64_t>(std::floor(std::ldexp(a[i][j], power) + 0.5));
      divides = divides || (i == 3 && motion.row[i][j] != 0);
    }
  }
  if (!divides) return Failure{Error::bad_argument, 0, "motion has a last row of zeros"};
  return motion;
}

Position expected_position(const uint16_t (&from)[3], const FrameMotion& motion, int bits) {
  // Within 3 * 2^42 * 2^16 + 2^58 = 2^60.
  int64_t at[4];
  for (int i = 0; i < 4; ++i)
    at[i] = motion.row[i][0] * from[0] + motion.row[i][1] * from[1] + motion.row[i][2] * from[2] + motion.row[i][3];
  const int64_t highest = (int64_t{1} << bits) - 1;
  Position position;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int64_t to = at[3] > 0 ? round_quotient(at[axis], at[3]) : from[axis];
    position[axis] = static_cast<uint16_t>(std::clamp<int64_t>(to, 0, highest));
  }
  return position;
}

Grid grid_of(const QuantizedMesh& mesh) {
  Grid grid;
  std::copy(mesh.origin, mesh.origin + 3, grid.origin);
  std::copy(mesh.step, mesh.step + 3, grid.step);
  grid.bits = mesh.position_bits;
  return grid;
}

QuantizedMesh moved(const QuantizedMesh& reference, const FrameMotion& motion, const Grid& grid) {
  PAC_ASSERT(within_bounds(motion) && grid.bits >= 1 && grid.bits <= 16);
  QuantizedMesh result = reference;
  result.position_bits = grid.bits;
  std::copy(grid.origin, grid.origin + 3, result.origin);
  std::copy(grid.step, grid.step + 3, result.step);
  for (QuantizedVertex& vertex : result.vertices) {
    const Position position = expected_position(vertex.position, motion, grid.bits);
    std::copy(position.begin(), position.end(), vertex.position);
  }
  return result;
}

bool fit_motion(std::span<const QuantizedVertex> reference, int reference_bits, std::span<const QuantizedVertex> frame,
                int frame_bits, FrameMotion& motion) {
  constexpr size_t kSample = 4096, kFewest = 16;
  constexpr int kRounds = 4;  // of reweighting: what moves by itself soon counts little
  if (reference.size() < kFewest) return false;
  const size_t step = (reference.size() + kSample - 1) / kSample;
  const Grid from = unit_grid(reference_bits), to = unit_grid(frame_bits);
  const double least_miss = std::ldexp(1.0, -frame_bits);
  Matrix matrix = {};
  for (int round = 0; round < kRounds; ++round) {
    ProjectiveFit fit;
    for (size_t v = 0; v < reference.size(); v += step) {
      double p[3], x[3];
      to_unit(std::to_array(reference[v].position), from, p);
      to_unit(std::to_array(frame[v].position), to, x);
      fit.add(p, x, round == 0 ? 1 : 1 / (miss_of(matrix, p, x) + least_miss));
    }
    if (!fit.solve(matrix)) return false;
  }
  const auto result = frame_motion(matrix, from, to);
  if (!result.ok()) return false;
  motion = *result;
  return true;
}

}  // namespace pac::geomcodec
