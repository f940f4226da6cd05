// Where the models of magnitude classes and of details start in streams that say so: what training on generated meshes
// found. bench/peers/geom_priors.cpp prints geomcodec/priors.inc and geomcodec/detail_priors.inc. FORMAT.md section 3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "geomcodec/symbol_model.h"

namespace pac::geomcodec {

// Residuals that are alike: positions by basis; green, then red and blue, by basis. Alpha has none.
enum PriorSet : uint32_t { kPriorPositions = 0, kPriorGreen = 4, kPriorRedBlue = 7, kPriorSets = 10 };
inline constexpr size_t kPriorContexts = 2 * kClasses + kClasses + 1;  // by scale in halves, then by other

// Position bases: previous and neighbors; extension and repeated; one parallelogram; two, more, chosen.
inline constexpr uint32_t kPriorOfPositionBasis[8] = {0, 0, 1, 2, 3, 3, 1, 3};
// Attribute bases: previous and neighbors; extension and one; two and more.
inline constexpr uint32_t kPriorOfAttributeBasis[6] = {0, 0, 1, 1, 2, 2};

using PriorModels = std::array<std::array<SymbolModel, kPriorContexts>, kPriorSets>;
extern const PriorModels kPriorModels;

// Details: positions; green; red and blue.
enum PriorDetails : uint32_t { kDetailsOfPositions, kDetailsOfGreen, kDetailsOfRedBlue, kDetailSets };
using PriorDetailModels = std::array<DetailModel, kDetailSets>;
extern const PriorDetailModels kPriorDetails;

}  // namespace pac::geomcodec
