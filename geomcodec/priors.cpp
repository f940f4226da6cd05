#include "geomcodec/priors.h"

namespace pac::geomcodec {
namespace {

// [set][context][class]: how probable, in parts of their sum; all 0 where training met too few: as untrained.
constexpr uint8_t kWeights[kPriorSets][kPriorContexts][SymbolModel::kSymbols] = {
#include "geomcodec/priors.inc"
};
// [set][class][detail], likewise.
constexpr uint8_t kDetailWeights[kDetailSets][kClasses][SymbolModel::kSymbols] = {
#include "geomcodec/detail_priors.inc"
};
constexpr int16_t kTrust = 3, kDetailTrust = 16;  // as if so many symbols had been seen

// Leaves `model` as it is where all weights are 0.
constexpr void start_from_weights(const uint8_t (&weight)[SymbolModel::kSymbols], int16_t trust, SymbolModel& model) {
  int sum[SymbolModel::kSymbols + 1] = {};
  for (size_t c = 0; c < SymbolModel::kSymbols; ++c) sum[c + 1] = sum[c] + weight[c];
  const int total = sum[SymbolModel::kSymbols];
  if (total == 0) return;
  for (size_t c = 0; c < SymbolModel::kSymbols; ++c)
    model.start[c] =
        static_cast<int16_t>(SymbolModel::kFloor * static_cast<int>(c) +
                             (SymbolModel::kTotal - SymbolModel::kFloor * SymbolModel::kSymbols) * sum[c] / total);
  model.seen = trust;
}

constexpr PriorModels models_of_weights() {
  PriorModels models{};
  for (size_t set = 0; set < kPriorSets; ++set) {
    for (size_t context = 0; context < kPriorContexts; ++context) {
      SymbolModel& model = models[set][context];
      model = kExpecting[context < 2 * kClasses ? context : 2 * (context - 2 * kClasses)];
      start_from_weights(kWeights[set][context], kTrust, model);
    }
  }
  return models;
}

constexpr PriorDetailModels details_of_weights() {
  PriorDetailModels details{};
  for (size_t set = 0; set < kDetailSets; ++set)
    for (size_t c = 0; c < kClasses; ++c)
      start_from_weights(kDetailWeights[set][c], kDetailTrust, details[set].of_class[c]);
  return details;
}

}  // namespace

constexpr PriorModels kPriorModels = models_of_weights();
constexpr PriorDetailModels kPriorDetails = details_of_weights();

}  // namespace pac::geomcodec
