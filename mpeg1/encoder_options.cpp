// What the encoder is asked for: whether it can be, and what follows from it for the whole sequence.
#include <algorithm>

#include "mpeg1/adapted_matrices.h"
#include "mpeg1/encoder_state.h"
#include "mpeg1/motion_search.h"

namespace pac::mpeg1 {
namespace {

constexpr int kRowsPerBand = 8;
constexpr double kFastIntraRounding = 0.375;  // of a step: the trellis rounds to nearest and decides itself

// Nearer to flat: 24 * (entry / 24)^(1/4) of the default one. P pictures repeat errors of all frequencies alike. Its 64
// bytes in each sequence header are little from so many macroblocks on (320x240).
constexpr size_t kLeastForFlatter = 300;
constexpr QuantizerMatrix kFlatterIntraMatrix = {8,  22, 23, 23, 24, 25, 25, 26, 22, 22, 23, 24, 25, 25, 26, 27,
                                                 23, 23, 24, 25, 25, 26, 26, 27, 23, 23, 24, 25, 25, 26, 27, 27,
                                                 23, 24, 25, 25, 26, 26, 27, 29, 24, 25, 25, 26, 26, 27, 29, 30,
                                                 24, 25, 25, 26, 27, 28, 30, 31, 25, 25, 26, 27, 28, 30, 31, 33};

bool is_valid(const std::optional<QuantizerMatrix>& matrix) {
  if (!matrix) return true;
  return std::all_of(matrix->begin(), matrix->end(), [](uint8_t entry) { return entry >= kMinMatrixEntry; });
}

}  // namespace

const char* problem_with(const SequenceOptions& o) {
  if (o.width < 1 || o.width > kMaxWidth) return "width is outside 1..4095";
  if (o.height < 1 || o.height > kMaxHeight) return "height is outside 1..2800";
  if (o.picture_rate_code < 1 || o.picture_rate_code > 8) return "picture_rate_code is outside 1..8";
  if (o.pel_aspect_ratio_code < 1 || o.pel_aspect_ratio_code > 14) return "pel_aspect_ratio_code is outside 1..14";
  if (o.gop_length < 1 || o.gop_length > kMaxGroupLength) return "gop_length is outside 1..132";
  if (!(o.quantizer_scale >= kLeastQuantizerScale && o.quantizer_scale <= 31))
    return "quantizer_scale is outside 0.1875..31";
  if (o.bit_rate_bps < 0 || o.bit_rate_bps > 400 * 0x3FFFE) return "bit_rate_bps is outside 0..104856800";
  if (o.vbv_buffer_size < 0 || o.vbv_buffer_size > 1023) return "vbv_buffer_size is outside 0..1023";
  if (o.slice_rows < 0 || o.threads < 0) return "slice_rows or threads is negative";
  if (!is_valid(o.intra_matrix) || !is_valid(o.non_intra_matrix)) return "a matrix entry is below 3";
  if (o.intra_matrix && (*o.intra_matrix)[0] != 8) return "the intra matrix must begin with 8";
  return nullptr;
}

Encoder::State::State(const SequenceOptions& o, Isa isa)
    : options(o),
      kernels(*kernels_for(isa)),
      pool(o.threads),
      columns(macroblock_columns(o.width)),
      rows(macroblock_rows(o.height)),
      reconstruction(16 * columns, 16 * rows),
      reference(16 * columns, 16 * rows),
      coarse(columns, rows),
      lookahead(columns, rows) {
  sequence.width = o.width;
  sequence.height = o.height;
  sequence.pel_aspect_ratio_code = o.pel_aspect_ratio_code;
  sequence.picture_rate_code = o.picture_rate_code;
  QuantizerMatrix intra_matrix = o.intra_matrix.value_or(kDefaultIntraMatrix);
  QuantizerMatrix non_intra_matrix = o.non_intra_matrix.value_or(kDefaultNonIntraMatrix);
  if (o.bit_rate_bps == 0 && o.quantizer_scale < 1) {
    intra_matrix = scaled_matrix(intra_matrix, o.quantizer_scale * intra_scale(0), true);
    non_intra_matrix = scaled_matrix(non_intra_matrix, o.quantizer_scale, false);
  }
  set_rate();
  set_matrices(intra_matrix, non_intra_matrix);
  make_lambdas();
  const size_t count = static_cast<size_t>(columns) * static_cast<size_t>(rows);
  macroblocks.resize(count);
  last_vectors.resize(count);
  ages.resize(count);
  still.resize(count);
  forced.resize(count);
  quantizers.resize(count);
  const int n_bands = std::max(1, rows / kRowsPerBand);
  bands.resize(static_cast<size_t>(n_bands));
  bits.resize(static_cast<size_t>(rows));
  for (int i = 0; i < n_bands; ++i) {
    bands[static_cast<size_t>(i)].first_row = rows * i / n_bands;
    bands[static_cast<size_t>(i)].end_row = rows * (i + 1) / n_bands;
    band_rows.push_back(rows * (i + 1) / n_bands - rows * i / n_bands);
  }
  if (o.adapt_matrices && o.effort != Effort::fast) {
    statistics.resize(bands.size());
    for (size_t i = 0; i < bands.size(); ++i) bands[i].statistics = &statistics[i];
  }
  bits_of_difference.resize(kMaxDifference + 1);
  for (int i = 0; i <= kMaxDifference; ++i)
    bits_of_difference[static_cast<size_t>(i)] = static_cast<uint8_t>(motion_bits(std::min(i, 60), 0, 1));
}

void Encoder::State::set_matrices(const QuantizerMatrix& intra_matrix, const QuantizerMatrix& non_intra_matrix) {
  sequence.intra_matrix = intra_matrix;
  sequence.non_intra_matrix = non_intra_matrix;
  sequence.has_intra_matrix = options.intra_matrix.has_value() || intra_matrix != kDefaultIntraMatrix;
  sequence.has_non_intra_matrix = options.non_intra_matrix.has_value() || non_intra_matrix != kDefaultNonIntraMatrix;
  make_quantizers(intra_matrix, options.effort == Effort::fast ? kFastIntraRounding : 0.5, intra);
  make_quantizers(non_intra_matrix, 0.0, non_intra);  // reconstruction lies half a step above the level
}

// For a sequence that begins with an I picture: what begins with a P picture has few intra macroblocks.
void Encoder::State::flatten_intra_matrix() {
  const bool is_default = !options.intra_matrix && sequence.intra_matrix == kDefaultIntraMatrix;
  if (is_default && options.effort != Effort::fast && options.gop_length > 1 && macroblocks.size() >= kLeastForFlatter)
    set_matrices(kFlatterIntraMatrix, sequence.non_intra_matrix);
}

// By the pictures since the last adaptation, which then count no more. A repeated sequence header may bring other
// matrices [2.4.3.2].
void Encoder::State::adapt_matrices() {
  if (statistics.empty()) return;
  for (size_t i = 1; i < statistics.size(); ++i) statistics[0].add(statistics[i]);
  const QuantizerMatrix adapted_intra = adapted_matrix(statistics[0], sequence.intra_matrix, true, lambda[1][1]);
  const QuantizerMatrix adapted_others = adapted_matrix(statistics[0], sequence.non_intra_matrix, false, lambda[0][1]);
  if (adapted_intra != sequence.intra_matrix || adapted_others != sequence.non_intra_matrix)
    set_matrices(adapted_intra, adapted_others);
  for (CoefficientStatistics& of_band : statistics) of_band.clear();
}

// The header's rate and buffer: a second of the rate by default; for a fixed quantizer as large as can be said.
void Encoder::State::set_rate() {
  has_rate = options.bit_rate_bps > 0;
  if (has_rate) sequence.bit_rate = static_cast<int>((options.bit_rate_bps + 399) / 400);
  const int64_t second = int64_t{400} * sequence.bit_rate / 16384;
  const int fallback = has_rate ? static_cast<int>(std::clamp<int64_t>(second, 4, 1023)) : 1023;
  sequence.vbv_buffer_size = options.vbv_buffer_size != 0 ? options.vbv_buffer_size : fallback;
  // 90 kHz ticks of a full buffer must fit vbv_delay's 16 bits.
  if (has_rate)
    sequence.vbv_buffer_size = std::max(
        1,
        std::min(sequence.vbv_buffer_size, static_cast<int>(int64_t{65000} * 400 * sequence.bit_rate / 90000 / 16384)));
  if (has_rate && options.vbv_buffer_size == 0) {  // a smaller buffer where that makes the parameters constrained
    SequenceHeader small = sequence;
    small.vbv_buffer_size = std::min(small.vbv_buffer_size, 20);
    if (is_constrained(small)) sequence.vbv_buffer_size = small.vbv_buffer_size;
  }
  sequence.constrained_parameters = is_constrained(sequence);
  if (has_rate)
    rate = RateControl(int64_t{400} * sequence.bit_rate, int64_t{16384} * sequence.vbv_buffer_size,
                       kPictureRatesMilli[options.picture_rate_code], options.gop_length, columns * rows);
}

const char* Encoder::State::problem_with_picture(const Frame420& frame, const PictureOptions& picture) const {
  if (frame.width() != options.width || frame.height() != options.height) return "frame has another size";
  if (picture.reference != nullptr &&
      (picture.reference->width() != options.width || picture.reference->height() != options.height))
    return "reference has another size";
  if (picture.type && *picture.type != PictureType::I && *picture.type != PictureType::P)
    return "the encoder writes I and P pictures";
  for (const Frame420* frame_after : picture.following)
    if (frame_after == nullptr || frame_after->width() != options.width || frame_after->height() != options.height)
      return "a frame that follows is missing or has another size";
  const size_t count = macroblocks.size();
  if (picture.candidates_per_macroblock < 0 ||
      picture.candidates.size() != count * static_cast<size_t>(picture.candidates_per_macroblock))
    return "not so many candidates as macroblocks ask for";
  if (!picture.quantizer_map.empty() && picture.quantizer_map.size() != count)
    return "quantizer_map has not one entry a macroblock";
  for (const uint8_t q : picture.quantizer_map)
    if (q < 1 || q > 31) return "quantizer_map entry outside 1..31";
  if (!picture.quantizer_factors.empty()) {
    if (picture.quantizer_factors.size() != count) return "quantizer_factors has not one entry a macroblock";
    if (has_rate || !picture.quantizer_map.empty())
      return "quantizer_factors need neither constant bit rate nor quantizer_map";
    for (const float factor : picture.quantizer_factors)
      if (!(factor >= 0.0625F && factor <= 16.0F)) return "quantizer_factors entry outside 1/16..16";
  }
  if (!picture.prices.empty() && picture.prices.size() != count) return "prices have not one entry a macroblock";
  if (picture.quantizer_scale != 0 && !(picture.quantizer_scale >= 1 && picture.quantizer_scale <= 31))
    return "quantizer_scale is outside 1..31";
  if (picture.code_again != nullptr && (has_rate || !picture.quantizer_map.empty()))
    return "code_again decides alone: no constant bit rate and no quantizer_map beside it";
  return nullptr;
}

}  // namespace pac::mpeg1
