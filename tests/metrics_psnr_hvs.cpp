#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/psnr_hvs.h"
#include "tests/support/metric_pictures.h"

namespace pac::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The columns: PSNR-HVS and PSNR-HVS-M of a numpy transcription of the authors' description with their printed tables;
// PSNR-HVS-M of Xiph's implementation in C (an integer DCT), as used by libvmaf, given the authors' table and blocks
// side by side.
TEST_CASE("PSNR-HVS and PSNR-HVS-M: two independent implementations agree within 1e-5 dB and 0.01 dB") {
  struct Pin {
    int width, height;
    Damage damage;
    int amount;
    double hvs_db, hvs_m_db, xiph_m_db;
  };
  constexpr Pin kPins[] = {
      {256, 192, Damage::noise, 8, 37.708012, 42.178485, 42.171345},
      {256, 192, Damage::noise, 40, 24.336275, 27.319786, 27.318611},
      {256, 192, Damage::blur, 1, 26.049743, 29.761095, 29.764012},
      {256, 192, Damage::blur, 3, 18.319994, 19.452111, 19.450203},
      {256, 192, Damage::blocks, 30, 28.089136, 30.966954, 30.968392},
      {256, 192, Damage::blocks, 90, 18.585570, 19.670294, 19.670579},
      {256, 192, Damage::bands, 12, 35.437301, 37.060819, 37.059061},
      {256, 192, Damage::bands, 40, 25.350799, 26.119279, 26.120724},
      {256, 192, Damage::tint, 6, 43.084837, 43.230599, 43.238082},
      {256, 192, Damage::no_shadow, 60, 22.528881, 22.550236, 22.550151},
      {61, 45, Damage::noise, 8, 37.695540, 44.601259, 44.595222},
      {61, 45, Damage::blocks, 90, 17.009379, 18.050358, 18.051460},
      {61, 45, Damage::no_shadow, 10, 36.223259, 36.537315, 36.533956},
  };
  for (const Pin& pin : kPins) {
    CAPTURE(damage_name(pin.damage));
    CAPTURE(pin.amount);
    CAPTURE(pin.width);
    const RgbImage scene = metric_scene(pin.width, pin.height);
    const PsnrHvs result = psnr_hvs_luma(scene.view(), damaged(scene, pin.damage, pin.amount).view());
    CHECK(std::abs(result.psnr_hvs_db - pin.hvs_db) < 1e-5);
    CHECK(std::abs(result.psnr_hvs_m_db - pin.hvs_m_db) < 1e-5);
    CHECK(std::abs(result.psnr_hvs_m_db - pin.xiph_m_db) < 0.01);
  }
}

TEST_CASE("PSNR-HVS: equal pictures are infinitely good, whatever their size") {
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 30}, {8, 8}, {50, 33}}) {
    const RgbImage scene = metric_scene(width, height);
    const PsnrHvs result = psnr_hvs_luma(scene.view(), scene.view());
    CHECK(result.psnr_hvs_db == kInfinity);
    CHECK(result.psnr_hvs_m_db == kInfinity);
  }
}

TEST_CASE("PSNR-HVS: a flat picture one level brighter is the weighted DC error alone, in small pictures too") {
  // The DC coefficient differs by 8; weighted 8 * 25.73509 / 16; its square over 64 coefficients.
  const double weighted = 8 * 25.73509 / 16, expected = 10 * std::log10(255 * 255 * 64 / (weighted * weighted));
  for (const int side : {3, 8, 40}) {
    GrayImage a(side, side), b(side, side);
    for (int y = 0; y < side; ++y) std::fill_n(b.row(y), side, uint8_t{1});
    const PsnrHvs result = psnr_hvs(a.view(), b.view());
    CHECK(result.psnr_hvs_db == doctest::Approx(expected).epsilon(1e-12));
    CHECK(result.psnr_hvs_m_db == doctest::Approx(expected).epsilon(1e-12));
  }
}

TEST_CASE("PSNR-HVS: worse with more damage, masking never makes it worse, symmetric") {
  const RgbImage scene = metric_scene(120, 90);
  for (const Damage damage : kDamages) {
    CAPTURE(damage_name(damage));
    PsnrHvs last{kInfinity, kInfinity};
    for (int step = 1; step <= 4; ++step) {
      const int amount = damage == Damage::blur ? step : damage == Damage::blocks ? 22 * step : 5 + 9 * step;
      const RgbImage test = damaged(scene, damage, amount);
      const PsnrHvs result = psnr_hvs_luma(scene.view(), test.view()),
                    swapped = psnr_hvs_luma(test.view(), scene.view());
      CAPTURE(amount);
      CHECK(result.psnr_hvs_db < last.psnr_hvs_db);
      CHECK(result.psnr_hvs_m_db < last.psnr_hvs_m_db);
      CHECK(result.psnr_hvs_m_db >= result.psnr_hvs_db);
      CHECK(swapped.psnr_hvs_m_db == result.psnr_hvs_m_db);
      last = result;
    }
  }
}

}  // namespace
}  // namespace pac::test
