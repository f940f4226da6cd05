// How finely each macroblock of a picture of the difference is quantized [Levoy95 s.5]: by what the renderer knows of
// it and by what the application says that it is worth. Of the encoder only: the stream says what was used.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "base/result.h"
#include "raster/scene.h"

namespace pac::sim {

// What the application puts before the rest. An error there counts `worth` times as much as elsewhere: its bits come
// from elsewhere where bytes are given, and are added where the quantizer is.
struct Foreground {
  std::vector<std::string> materials;  // of L, by name
  bool moving = false;                 // whatever belongs to an object
  double worth = 4;                    // 1/16..16; below 1: behind the rest

  bool is_on() const { return moving || !materials.empty(); }
};

// "tartan,moving": materials and whatever moves.
void read_foreground(std::string_view names, Foreground& foreground);

// What an error counts where a pixel shows id (face + 1, 0 = background); empty: once everywhere. Fails with
// bad_argument: worth outside its range, a material that the scene has not.
Result<std::vector<float>> worth_of_ids(const raster::Scene& scene, const Foreground& foreground);

class QuantizerAdaptation {
 public:
  QuantizerAdaptation() = default;  // alike everywhere

  // Fails as worth_of_ids().
  static Result<QuantizerAdaptation> create(const raster::Scene& low, const Foreground& foreground);

  // What mpeg1::PictureOptions::quantizer_factors takes, by the ids that L shows and, where `masks`, by how much of an
  // error H's texture hides; empty: alike everywhere. Valid until the next call.
  std::span<const float> factors(ConstRgbView high, PlaneView<const uint32_t> id, bool masks);

 private:
  void mask(ConstRgbView high);
  void weigh(PlaneView<const uint32_t> id);

  std::vector<float> worth_;  // by id; empty: 1 everywhere
  std::vector<float> factors_;
};

}  // namespace pac::sim
