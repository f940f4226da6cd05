#include "sim/camera_code.h"

#include <cmath>

#include "sim/float_code.h"

namespace pac::sim {

namespace {

// Rows of clip_from_world, then the eye.
enum Row : size_t { kX, kY, kZ, kW, kEye };

struct Numbers {
  float at[5][4] = {};  // [Row][column]; the eye has three

  double operator()(size_t row, size_t column) const { return static_cast<double>(at[row][column]); }
  double dot(size_t row, size_t other) const {
    const Numbers& n = *this;
    return (n(row, 0) * n(other, 0) + n(row, 1) * n(other, 1)) + n(row, 2) * n(other, 2);
  }
};

Numbers numbers_of(const raster::Camera& camera) {
  Numbers numbers;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) numbers.at[row][column] = camera.clip_from_world[column][row];
  for (int axis = 0; axis < 3; ++axis) numbers.at[kEye][axis] = camera.eye[axis];
  return numbers;
}

raster::Camera camera_of(const Numbers& numbers) {
  raster::Camera camera;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) camera.clip_from_world[column][row] = numbers.at[row][column];
  for (int axis = 0; axis < 3; ++axis) camera.eye[axis] = numbers.at[kEye][axis];
  return camera;
}

double cross(const Numbers& n, size_t axis) {  // of the rows w and x
  const size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  return n(kW, a) * n(kX, b) - n(kW, b) * n(kX, a);
}

// Rows x, y, w of a rigid camera are the axes of the view, scaled; row z is a multiple of w but for its last entry; the
// last entries put the eye at x = y = w = 0. Doubles and + - * / sqrt in a fixed order: equal on every machine.
class Predictor {
 public:
  explicit Predictor(const Numbers& base) : base_(base) {
    for (size_t axis = 1; axis < 3; ++axis)
      if (std::fabs(base(kW, axis)) > std::fabs(base(kW, largest_))) largest_ = axis;
    depth_scale_ = base(kZ, largest_) / base(kW, largest_);
    double sum = 0, squares = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      sum += base(kY, axis) * cross(base, axis);
      squares += cross(base, axis) * cross(base, axis);
    }
    up_scale_ = sum / squares;
  }

  struct Place {
    size_t row, column;
  };
  static constexpr size_t kCount = 19;

  // In the order in which they are coded.
  Place place(size_t step) const {
    if (step < 3) return {kEye, step};
    if (step < 6) return {kW, (largest_ + step - 2) % 3};  // the largest last
    if (step < 9) return {kX, (step - 5) % 3};             // y first: 0 where the camera does not roll
    if (step < 12) return {kY, step - 9};
    if (step < 15) return {kZ, step - 12};
    constexpr Row kLast[] = {kX, kY, kW, kZ};
    return {kLast[step - 15], 3};
  }

  // `known` holds what came before.
  float predict(Place place, const Numbers& known) const {
    return float_guess(rigid(place, known), base_.at[place.row][place.column]);
  }

 private:
  double rigid(Place place, const Numbers& known) const {
    const auto [row, column] = place;
    const double before = base_(row, column);
    if (row == kEye) return before;
    if (column == 3 && row == kZ) return before + depth_scale_ * (known(kW, 3) - base_(kW, 3));
    if (column == 3) return -known.dot(row, kEye);
    if (row == kZ) return depth_scale_ * known(kW, column);
    if (row == kY) return up_scale_ * cross(known, column);
    if (row == kW) return column == largest_ ? last_of_direction(known) : before;
    return column == 1 ? before : across(column, known);
  }

  double last_of_direction(const Numbers& known) const {
    const double a = known(kW, (largest_ + 1) % 3), b = known(kW, (largest_ + 2) % 3);
    const double rest = std::sqrt((base_.dot(kW, kW) - a * a) - b * b);
    return base_(kW, largest_) < 0 ? -rest : rest;
  }

  // Row x: orthogonal to w, as long as before, its middle entry known.
  double across(size_t column, const Numbers& known) const {
    const double w0 = known(kW, 0), w2 = known(kW, 2), x1 = known(kX, 1);
    const double square = w0 * w0 + w2 * w2, along = -(x1 * known(kW, 1)) / square;
    const double length = std::sqrt(((base_.dot(kX, kX) - x1 * x1) - along * along * square) / square);
    const bool same_side = base_(kX, 2) * w0 - base_(kX, 0) * w2 >= 0;
    const double side = same_side ? length : -length;
    return column == 0 ? along * w0 - side * w2 : along * w2 + side * w0;
  }

  const Numbers& base_;
  size_t largest_ = 0;
  double depth_scale_ = 0, up_scale_ = 0;
};

}  // namespace

void write_camera_change(BitWriter& writer, const raster::Camera& camera, const raster::Camera& base) {
  const Numbers now = numbers_of(camera), before = numbers_of(base);
  const Predictor predictor(before);
  Numbers known;
  for (size_t step = 0; step < Predictor::kCount; ++step) {
    const Predictor::Place place = predictor.place(step);
    const float value = now.at[place.row][place.column];
    put_float_change(writer, value, predictor.predict(place, known));
    known.at[place.row][place.column] = value;
  }
}

raster::Camera read_camera_change(BitReader& reader, const raster::Camera& base) {
  const Numbers before = numbers_of(base);
  const Predictor predictor(before);
  Numbers known;
  for (size_t step = 0; step < Predictor::kCount; ++step) {
    const Predictor::Place place = predictor.place(step);
    known.at[place.row][place.column] = take_float_change(reader, predictor.predict(place, known));
  }
  return camera_of(known);
}

}  // namespace pac::sim
