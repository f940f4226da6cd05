// The tables of contexts that a section by tables tells nothing of: what training, or the neighbors' classes alone, let
// expect. FORMAT.md section 15.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geomcodec/symbol_model.h"

namespace pac::geomcodec {

inline constexpr int kTableBits = 11;  // frequencies of a table add up to 2^11
inline constexpr uint32_t kTableTotal = 1u << kTableBits;
inline constexpr size_t kTableSymbols = 16;

// One context's symbols; freq 0 where one never occurs.
struct FrequencyTable {
  struct Entry {
    uint16_t freq = 0, start = 0;
  };
  std::array<Entry, kTableSymbols> entry;
};

// With the symbol of each of the 2^11 places.
struct LookupTable : FrequencyTable {
  uint8_t symbol[kTableTotal];
  void assign(const FrequencyTable& table);
};

// Contexts as table_positions.h and attribute_coder.h number them.
enum class Expected : uint8_t { nothing, faces, positions, colors, others };

// [context]: its table, for as long as the program runs; empty for `nothing`.
const std::vector<const LookupTable*>& expected_tables(Expected what);

// The contexts of the faces' walk, as connectivity.cpp numbers them, and its symbols. Their expected tables are
// geomcodec/walk_priors.inc, which bench/peers/geom_priors.cpp prints.
inline constexpr size_t kWalkContexts = 696, kWalkSymbols = 8;

// The contexts of positions: by role, number of parallelograms (none, one, more), mean class of the neighbors in
// halves.
inline constexpr uint32_t kPositionScales = 2 * kClasses + 1;
inline constexpr size_t kPositionContexts = 3 * 3 * kPositionScales;

// The contexts of the other attributes: of the first component by basis and the neighbors' classes, of the others by
// the largest class so far and the neighbors' classes; then of "the same as the sibling's".
inline constexpr uint32_t kScaleHalves = 2 * kClasses + 1, kScales = kClasses + 1, kOtherClasses = 16;
inline constexpr uint32_t kFirstContexts = 3 * kScaleHalves, kOtherContexts = kOtherClasses * kScales;
inline constexpr uint32_t kSiblingContext = kFirstContexts + 3 * kOtherContexts;
inline constexpr size_t kAttributeContexts = kSiblingContext + 2;

}  // namespace pac::geomcodec
