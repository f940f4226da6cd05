#include "sim/object_code.h"

#include <cmath>
#include <cstring>

#include "sim/float_code.h"

namespace pac::sim {

namespace {

struct Vector {
  double at[3] = {};
};

Vector column(const glm::mat4& m, int number) {
  return {{static_cast<double>(m[number][0]), static_cast<double>(m[number][1]), static_cast<double>(m[number][2])}};
}

double dot(const Vector& a, const Vector& b) {
  return (a.at[0] * b.at[0] + a.at[1] * b.at[1]) + a.at[2] * b.at[2];
}

Vector cross(const Vector& a, const Vector& b) {
  Vector out;
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3, k = (i + 2) % 3;
    out.at[i] = a.at[j] * b.at[k] - a.at[k] * b.at[j];
  }
  return out;
}

// Columns 0 to 2 of a moved rigid body keep their lengths and stay orthogonal. Doubles and + - * / sqrt in a fixed
// order: equal on every machine.
class Predictor {
 public:
  explicit Predictor(const glm::mat4& base) : base_(base) {
    const Vector across = cross(column(base, 0), column(base, 1));
    scale_ = dot(column(base, 2), across) / dot(across, across);
    for (int row = 1; row < 3; ++row)
      if (std::fabs(base[0][row]) > std::fabs(base[0][largest_])) largest_ = row;
  }

  struct Place {
    int column, row;
  };
  static constexpr int kCount = 9;

  // In the order in which they are coded; column 0 is in `known` when column 1 begins.
  Place place(int step, const glm::mat4& known) const {
    if (step < 3) return {0, (largest_ + step + 1) % 3};  // the largest last
    if (step >= 6) return {2, step - 6};
    return {1, (smallest(known) + step - 3) % 3};
  }

  // `known` holds what came before.
  float predict(int step, const glm::mat4& known) const {
    const Place at = place(step, known);
    return float_guess(rigid(step, at, known), base_[at.column][at.row]);
  }

 private:
  static int smallest(const glm::mat4& known) {
    int found = 0;
    for (int row = 1; row < 3; ++row)
      if (std::fabs(known[0][row]) < std::fabs(known[0][found])) found = row;
    return found;
  }

  double rigid(int step, Place at, const glm::mat4& known) const {
    if (step == 2) return last_of_first(known);
    if (step >= 6) return scale_ * cross(column(known, 0), column(known, 1)).at[at.row];
    if (step >= 4) return across(step == 4, known);
    return static_cast<double>(base_[at.column][at.row]);
  }

  double last_of_first(const glm::mat4& known) const {
    const Vector before = column(base_, 0);
    const auto a = static_cast<double>(known[0][(largest_ + 1) % 3]);
    const auto b = static_cast<double>(known[0][(largest_ + 2) % 3]);
    const double rest = std::sqrt((dot(before, before) - a * a) - b * b);
    return base_[0][largest_] < 0 ? -rest : rest;
  }

  // Column 1: orthogonal to column 0, as long as before, its entry in row f known; rows j (`first`) and k.
  double across(bool first, const glm::mat4& known) const {
    const int f = smallest(known), j = (f + 1) % 3, k = (f + 2) % 3;
    const Vector x = column(known, 0), before = column(base_, 1);
    const auto e = static_cast<double>(known[1][f]);
    const double xj = x.at[j], xk = x.at[k], square = xj * xj + xk * xk, along = -(e * x.at[f]) / square;
    const double length = std::sqrt(((dot(before, before) - e * e) - along * along * square) / square);
    const double side = before.at[k] * xj - before.at[j] * xk >= 0 ? length : -length;
    return first ? along * xj - side * xk : along * xk + side * xj;
  }

  const glm::mat4& base_;
  int largest_ = 0;
  double scale_ = 0;
};

constexpr size_t kTurnBytes = 3 * sizeof(glm::vec4);  // columns 0 to 2

void write_change(BitWriter& writer, const glm::mat4& now, const glm::mat4& before) {
  for (int row = 0; row < 3; ++row) put_float_change(writer, now[3][row], before[3][row]);
  const bool is_turned = std::memcmp(&now, &before, kTurnBytes) != 0;
  writer.put(is_turned ? 1 : 0, 1);
  if (!is_turned) return;
  const Predictor predictor(before);
  glm::mat4 known(1.0f);
  for (int step = 0; step < Predictor::kCount; ++step) {
    const auto [column, row] = predictor.place(step, known);
    put_float_change(writer, now[column][row], predictor.predict(step, known));
    known[column][row] = now[column][row];
  }
}

glm::mat4 read_change(BitReader& reader, const glm::mat4& before) {
  glm::mat4 now = before;
  for (int row = 0; row < 3; ++row) now[3][row] = take_float_change(reader, before[3][row]);
  if (!reader.read_flag()) return now;
  const Predictor predictor(before);
  glm::mat4 known(1.0f);
  for (int step = 0; step < Predictor::kCount; ++step) {
    const auto [column, row] = predictor.place(step, known);
    known[column][row] = take_float_change(reader, predictor.predict(step, known));
    now[column][row] = known[column][row];
  }
  return now;
}

}  // namespace

void write_object_changes(BitWriter& writer, std::span<const glm::mat4> now, std::span<const glm::mat4> before) {
  PAC_ASSERT(now.size() == before.size());
  if (now.empty()) return;
  bool any = false;
  for (size_t i = 0; i < now.size(); ++i) any = any || !same_transform(now[i], before[i]);
  writer.put(any ? 1 : 0, 1);
  if (!any) return;
  for (size_t i = 0; i < now.size(); ++i) {
    const bool is_moved = !same_transform(now[i], before[i]);
    writer.put(is_moved ? 1 : 0, 1);
    if (is_moved) write_change(writer, now[i], before[i]);
  }
}

Transforms read_object_changes(BitReader& reader, std::span<const glm::mat4> before) {
  Transforms now(before.begin(), before.end());
  if (now.empty() || !reader.read_flag()) return now;
  for (glm::mat4& transform : now)
    if (reader.read_flag()) transform = read_change(reader, glm::mat4(transform));
  return now;
}

}  // namespace pac::sim
