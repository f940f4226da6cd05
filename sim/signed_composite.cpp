#include "sim/signed_composite.h"

#include <vector>

#include "base/kernels/kernels.h"

namespace pac::sim {

namespace {

// The sum fits 16 bits, too.
template <int kBits>
int16_t rounded(int value) {
  return static_cast<int16_t>(static_cast<int16_t>(value + (1 << (kBits - 1))) >> kBits);
}

// Row y of a chroma plane at twice its resolution, by weights 3/4 and 1/4 in each direction. 16 bits hold every sum:
// samples keep two of their bits below the point.
class UpsampledRow {
  static constexpr int kKept = 2;

 public:
  explicit UpsampledRow(int half_width)
      : n_(half_width), column_(static_cast<size_t>(half_width) + 2), out_(2 * static_cast<size_t>(half_width)) {}

  const int16_t* of(const BorderedPlane& half, int y) {
    const int near = y / 2;
    const int16_t *a = half.row(near) - 1, *b = half.row((y & 1) != 0 ? near + 1 : near - 1) - 1;
    int16_t *column = column_.data(), *out = out_.data();
    for (int x = 0; x < n_ + 2; ++x)
      column[x] = static_cast<int16_t>(3 * rounded<kCarriedBits - kKept>(a[x]) + rounded<kCarriedBits - kKept>(b[x]));
    for (int x = 0; x < n_; ++x) {
      const int here = 3 * column[x + 1];
      out[2 * x] = rounded<4 + kKept>(here + column[x]);
      out[2 * x + 1] = rounded<4 + kKept>(here + column[x + 2]);
    }
    return out;
  }

 private:
  int n_;
  std::vector<int16_t> column_, out_;
};

}  // namespace

void composite_signed(ConstRgbView low, const BorderedPlane& y, const BorderedPlane& cb, const BorderedPlane& cr,
                      RgbView composite, Isa isa) {
  PAC_ASSERT(low.width == y.width() && low.height == y.height());
  PAC_ASSERT(low.width == composite.width && low.height == composite.height);
  const Kernels* table = kernels_for(isa);
  PAC_ASSERT(table != nullptr);
  UpsampledRow u(cb.width()), v(cr.width());
  std::vector<int16_t> luma(static_cast<size_t>(low.width));
  for (int row = 0; row < low.height; ++row) {
    const int16_t* from = y.row(row);
    int16_t* to = luma.data();
    for (int x = 0; x < low.width; ++x) to[x] = rounded<kCarriedBits>(from[x]);
    table->warp.composite_signed_row(low.row(row), to, u.of(cb, row), v.of(cr, row), static_cast<size_t>(low.width),
                                     composite.row(row));
  }
}

}  // namespace pac::sim
