#include "sim/reprojection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/kernels/kernels.h"

namespace pac::sim {

namespace {

struct Matrix {
  double at[4][4] = {};
};

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix product;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      product.at[r][c] =
          ((a.at[r][0] * b.at[0][c] + a.at[r][1] * b.at[1][c]) + a.at[r][2] * b.at[2][c]) + a.at[r][3] * b.at[3][c];
  return product;
}

Matrix matrix_of(const glm::mat4& m) {
  Matrix matrix;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) matrix.at[r][c] = static_cast<double>(m[c][r]);
  return matrix;
}

Matrix matrix_of(const MovedView& view) {
  return matrix_of(view.camera.clip_from_world) * matrix_of(view.world_from_object);
}

void swap_rows(Matrix& matrix, int a, int b) {
  for (int c = 0; c < 4; ++c) std::swap(matrix.at[a][c], matrix.at[b][c]);
}

// Gauss-Jordan with the largest pivot. A singular matrix gives numbers that are not finite, hence kWarpNowhere.
Matrix inverse(Matrix m) {
  Matrix result;
  for (int i = 0; i < 4; ++i) result.at[i][i] = 1;
  for (int column = 0; column < 4; ++column) {
    int pivot = column;
    for (int r = column + 1; r < 4; ++r)
      if (std::fabs(m.at[r][column]) > std::fabs(m.at[pivot][column])) pivot = r;
    swap_rows(m, pivot, column);
    swap_rows(result, pivot, column);
    const double divisor = m.at[column][column];
    for (int c = 0; c < 4; ++c) {
      m.at[column][c] = m.at[column][c] / divisor;
      result.at[column][c] = result.at[column][c] / divisor;
    }
    for (int r = 0; r < 4; ++r) {
      if (r == column) continue;
      const double factor = m.at[r][column];
      for (int c = 0; c < 4; ++c) {
        m.at[r][c] -= factor * m.at[column][c];
        result.at[r][c] -= factor * result.at[column][c];
      }
    }
  }
  return result;
}

// Clip space / w of pixel index (x, y) at u = 1 - window z.
Matrix clip_from_pixel(int width, int height, double sample_x, double sample_y) {
  Matrix matrix;
  matrix.at[0][0] = 2.0 / width;
  matrix.at[0][3] = 2.0 * sample_x / width - 1.0;
  matrix.at[1][1] = -2.0 / height;
  matrix.at[1][3] = 1.0 - 2.0 * sample_y / height;
  matrix.at[2][2] = -2.0;
  matrix.at[2][3] = 1.0;
  matrix.at[3][3] = 1.0;
  return matrix;
}

// Its inverse on homogeneous coordinates.
Matrix pixel_from_clip(int width, int height, double sample_x, double sample_y) {
  Matrix matrix;
  matrix.at[0][0] = 0.5 * width;
  matrix.at[0][3] = 0.5 * width - sample_x;
  matrix.at[1][1] = -0.5 * height;
  matrix.at[1][3] = 0.5 * height - sample_y;
  matrix.at[2][2] = -0.5;
  matrix.at[2][3] = 0.5;
  matrix.at[3][3] = 1.0;
  return matrix;
}

struct Window {
  int width, height;
  double sample_x, sample_y;
};

Matrix window_from_window(const Matrix& from, const Matrix& to, const Window& w) {
  return (pixel_from_clip(w.width, w.height, w.sample_x, w.sample_y) * to) *
         (inverse(from) * clip_from_pixel(w.width, w.height, w.sample_x, w.sample_y));
}

void make_flow(int width, int height, Flow& flow) {
  if (flow.x_64.width() == width && flow.x_64.height() == height) return;
  flow = {Image<int32_t, 1>(width, height), Image<int32_t, 1>(width, height), DepthImage(width, height)};
}

}  // namespace

Reprojection::Reprojection(const raster::Camera& from, const raster::Camera& to, int width, int height, double sample_x,
                           double sample_y) {
  const Matrix all = window_from_window(matrix_of(from.clip_from_world), matrix_of(to.clip_from_world),
                                        {width, height, sample_x, sample_y});
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) matrix_[r][c] = all.at[r][c];
}

Reprojection::Reprojection(const MovedView& from, const MovedView& to, int width, int height, double sample_x,
                           double sample_y) {
  const Matrix all = window_from_window(matrix_of(from), matrix_of(to), {width, height, sample_x, sample_y});
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) matrix_[r][c] = all.at[r][c];
}

ReprojectionRow Reprojection::row(int y, int first) const {
  ReprojectionRow row;
  for (int c = 0; c < 4; ++c) {
    const double unit = c < 2 ? kWarpPhases : 1;  // of x and y, a power of two
    const double at_left = matrix_[c][3] + matrix_[c][1] * y;
    row.origin[c] = static_cast<float>(unit * (first == 0 ? at_left : at_left + matrix_[c][0] * first));
    row.per_pixel[c] = static_cast<float>(unit * matrix_[c][0]);
    row.per_depth[c] = static_cast<float>(unit * matrix_[c][2]);
  }
  return row;
}

void reproject(const Reprojection& reprojection, PlaneView<const float> depth, Flow& flow, Isa isa) {
  make_flow(depth.width, depth.height, flow);
  const Kernels* table = kernels_for(isa);
  PAC_ASSERT(table != nullptr);
  for (int y = 0; y < depth.height; ++y)
    table->warp.reproject_row(reprojection.row(y), depth.row(y), static_cast<size_t>(depth.width), flow.x_64.row(y),
                              flow.y_64.row(y), flow.u_before.row(y));
}

void reproject(std::span<const Reprojection> ways, std::span<const uint32_t> way_of_id, PlaneView<const float> depth,
               PlaneView<const uint32_t> id, Flow& flow, Isa isa) {
  make_flow(depth.width, depth.height, flow);
  const Kernels* table = kernels_for(isa);
  PAC_ASSERT(table != nullptr);
  for (int y = 0; y < depth.height; ++y)
    for_each_way(ways, way_of_id, id.row(y), depth.width, [&](int first, int n, const Reprojection* way) {
      int32_t *x_64 = flow.x_64.row(y) + first, *y_64 = flow.y_64.row(y) + first;
      float* u_before = flow.u_before.row(y) + first;
      if (way != nullptr) {
        table->warp.reproject_row(way->row(y, first), depth.row(y) + first, static_cast<size_t>(n), x_64, y_64,
                                  u_before);
        return;
      }
      std::fill_n(x_64, n, kWarpNowhere);
      std::fill_n(y_64, n, kWarpNowhere);
      std::fill_n(u_before, n, 0.0f);
    });
}

}  // namespace pac::sim
