#include "sim/signed_composite.h"

#include <vector>

#include "base/kernels/kernels.h"

namespace pac::sim {

void composite_signed(ConstRgbView low, const BorderedPlane& y, const BorderedPlane& cb, const BorderedPlane& cr,
                      RgbView composite, Isa isa) {
  PAC_ASSERT(low.width == y.width() && low.height == y.height());
  PAC_ASSERT(low.width == composite.width && low.height == composite.height);
  const Kernels* table = kernels_for(isa);
  PAC_ASSERT(table != nullptr);
  if (low.empty()) return;
  const WarpKernels& kernels = table->warp;
  const auto half_width = static_cast<size_t>(cb.width());
  std::vector<int16_t> u(2 * half_width), v(2 * half_width);
  for (int row = 0; row < low.height; ++row) {
    const int near = row / 2, far = (row & 1) != 0 ? near + 1 : near - 1;
    kernels.upsample_carried_row(cb.row(near), cb.row(far), half_width, u.data());
    kernels.upsample_carried_row(cr.row(near), cr.row(far), half_width, v.data());
    kernels.composite_signed_row(low.row(row), y.row(row), u.data(), v.data(), static_cast<size_t>(low.width),
                                 composite.row(row));
  }
}

}  // namespace pac::sim
