#include "geomcodec/expected_tables.h"

#include <algorithm>

#include "geomcodec/priors.h"

namespace pac::geomcodec {
namespace {

FrequencyTable table_of(const SymbolModel& model) {
  const auto begin = [&](size_t symbol) {
    const int32_t start = symbol < kTableSymbols ? model.start[symbol] : SymbolModel::kTotal;
    const int32_t spare = static_cast<int32_t>(kTableTotal - kTableSymbols);
    return static_cast<uint32_t>(symbol) + static_cast<uint32_t>(start * spare / SymbolModel::kTotal);
  };
  FrequencyTable table;
  for (size_t s = 0; s < kTableSymbols; ++s)
    table.entry[s] = {static_cast<uint16_t>(begin(s + 1) - begin(s)), static_cast<uint16_t>(begin(s))};
  return table;
}

// Tables that contexts share.
class Tables {
 public:
  Tables(size_t n_contexts, size_t n_tables) : of_context_(n_contexts) { tables_.reserve(n_tables); }
  const LookupTable* add(const FrequencyTable& table) {
    tables_.emplace_back().assign(table);
    return &tables_.back();
  }
  const LookupTable* add(const SymbolModel& model) { return add(table_of(model)); }
  const LookupTable*& operator[](size_t context) { return of_context_[context]; }
  const std::vector<const LookupTable*>& of_context() const { return of_context_; }

 private:
  std::vector<LookupTable> tables_;
  std::vector<const LookupTable*> of_context_;
};

// [context][symbol]
constexpr uint8_t kWalkWeights[kWalkContexts][kWalkSymbols] = {
#include "geomcodec/walk_priors.inc"
};

FrequencyTable table_of(const uint8_t (&weight)[kWalkSymbols]) {
  constexpr uint32_t kSpare = kTableTotal - uint32_t{kWalkSymbols};
  uint32_t total = 0, lower = 0, start = 0;
  for (const uint8_t part : weight) total += part;
  FrequencyTable table;
  for (size_t s = 0; s < kWalkSymbols; ++s) {
    lower += weight[s];
    const uint32_t end = static_cast<uint32_t>(s + 1) + kSpare * lower / total;
    table.entry[s] = {static_cast<uint16_t>(end - start), static_cast<uint16_t>(start)};
    start = end;
  }
  return table;
}

// A class's models by scale and by other; the highest scale has that before it.
using ClassRow = const SymbolModel*;
const SymbolModel& by_scale(ClassRow row, size_t scale) {
  return row[std::min<size_t>(scale, 2 * kClasses - 1)];
}
const SymbolModel& by_other(ClassRow row, size_t other) {
  return row[2 * kClasses + other];
}

// Contexts that training met too seldom have the rows of others: rows that are alike share a table.
Tables tables_of_faces() {
  const auto same_row = [](size_t one, size_t other) {
    return std::equal(kWalkWeights[one], kWalkWeights[one] + kWalkSymbols, kWalkWeights[other]);
  };
  const auto first_like = [&](size_t context) {
    size_t first = 0;
    while (!same_row(first, context)) ++first;
    return first;
  };
  size_t n_rows = 0;
  for (size_t context = 0; context < kWalkContexts; ++context) n_rows += first_like(context) == context ? 1 : 0;
  Tables tables(kWalkContexts, n_rows);
  for (size_t context = 0; context < kWalkContexts; ++context) {
    const size_t first = first_like(context);
    tables[context] = first < context ? tables[first] : tables.add(table_of(kWalkWeights[context]));
  }
  return tables;
}

Tables tables_of_positions() {
  constexpr uint32_t kSet[3] = {0, 2, 3};  // by how many parallelograms
  Tables tables(kPositionContexts, 3 * kPositionScales);
  for (size_t context = 0; context < 3 * kPositionScales; ++context) {
    const ClassRow row = kPriorModels[kPriorPositions + kSet[context / kPositionScales]].data();
    const LookupTable* table = tables.add(by_scale(row, context % kPositionScales));
    for (size_t role = 0; role < 3; ++role) tables[role * 3 * kPositionScales + context] = table;
  }
  return tables;
}

// first: sets by basis; others: the set of the other components.
Tables tables_of_attribute(const std::array<ClassRow, 3>& first, const std::array<ClassRow, 3>& others) {
  Tables tables(kAttributeContexts, kFirstContexts + 3 * kOtherClasses + 1);
  for (size_t context = 0; context < kFirstContexts; ++context)
    tables[context] = tables.add(by_scale(first[context / kScaleHalves], context % kScaleHalves));
  for (size_t component = 0; component < 3; ++component) {
    for (size_t other = 0; other < kOtherClasses; ++other) {
      const LookupTable* table = tables.add(by_other(others[component], other));
      const size_t context = kFirstContexts + component * kOtherContexts + other * kScales;
      for (size_t scale = 0; scale < kScales; ++scale) tables[context + scale] = table;
    }
  }
  tables[kSiblingContext] = tables[kSiblingContext + 1] = tables.add(SymbolModel(2));
  return tables;
}

constexpr auto kUntrained = [] {
  std::array<SymbolModel, kPriorContexts> models;
  for (size_t i = 0; i < kPriorContexts; ++i) models[i] = kExpecting[i < 2 * kClasses ? i : 2 * (i - 2 * kClasses)];
  return models;
}();

Tables tables_of_colors() {
  const ClassRow red_blue = kPriorModels[kPriorRedBlue + 2].data();
  return tables_of_attribute(
      {kPriorModels[kPriorGreen].data(), kPriorModels[kPriorGreen + 1].data(), kPriorModels[kPriorGreen + 2].data()},
      {red_blue, red_blue, kUntrained.data()});
}

Tables tables_of_others() {
  const ClassRow row = kUntrained.data();
  return tables_of_attribute({row, row, row}, {row, row, row});
}

}  // namespace

void LookupTable::assign(const FrequencyTable& table) {
  entry = table.entry;
  for (size_t s = 0; s < kTableSymbols; ++s)
    std::fill_n(symbol + entry[s].start, entry[s].freq, static_cast<uint8_t>(s));
}

const std::vector<const LookupTable*>& expected_tables(Expected what) {
  static const std::vector<const LookupTable*> none;
  switch (what) {
    case Expected::nothing:
      break;
    case Expected::faces: {
      static const Tables faces = tables_of_faces();
      return faces.of_context();
    }
    case Expected::positions: {
      static const Tables positions = tables_of_positions();
      return positions.of_context();
    }
    case Expected::colors: {
      static const Tables colors = tables_of_colors();
      return colors.of_context();
    }
    case Expected::others: {
      static const Tables others = tables_of_others();
      return others.of_context();
    }
  }
  return none;
}

}  // namespace pac::geomcodec
