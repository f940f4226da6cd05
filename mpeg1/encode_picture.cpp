// One picture: its task for the bands, its bits; coded again until the caller or the rate control keeps it.
#include <algorithm>

#include "mpeg1/encoder_state.h"

namespace pac::mpeg1 {
namespace {

constexpr int kLargeColumns = 64;  // macroblocks, from which on best looks twice as far

}  // namespace

PictureTask Encoder::State::make_task(PictureType type, const PictureOptions& picture) {
  PictureTask task;
  task.residual.kernels = &kernels;
  task.residual.intra = &intra;
  task.residual.non_intra = &non_intra;
  task.residual.lambda = lambda[type == PictureType::I ? 1 : 0];
  task.residual.choice = options.effort == Effort::fast ? LevelChoice::drop_small : LevelChoice::trellis;
  task.effort = options.effort;
  task.type = type;
  task.columns = columns;
  task.rows = rows;
  task.slice_rows = options.slice_rows != 0 ? std::min(options.slice_rows, rows) : rows;
  task.source = source_planes;
  task.target = Planes::of(reconstruction);
  task.reference = Planes::of(reference);
  if (type == PictureType::P && picture.reference != nullptr) {
    if (replaced.width() == 0) replaced = Frame420(16 * columns, 16 * rows);
    fill_planes(view_of(*picture.reference), Planes::of(replaced));
    task.reference = Planes::of(replaced);
  }
  if (options.effort == Effort::best && columns >= kLargeColumns) task.f_code = 5;
  if (type == PictureType::P && options.effort != Effort::fast) {
    const bool is_replaced = picture.reference != nullptr;
    if (!is_replaced) task.ahead_vectors = lookahead.vectors(frame_in_group);
    if (task.ahead_vectors == nullptr)
      task.coarse_vectors = coarse.search(is_replaced ? &task.reference : nullptr, task.f_code, kernels.motion, pool);
    task.coarse_columns = coarse.block_columns();
  }
  task.quantizers = quantizers.data();
  if (!wanted.empty()) {
    task.wanted = wanted.data();
    task.lambdas = lambdas.data();
  }
  task.is_replaced = picture.reference != nullptr;
  // Not where the caller replaces the reference: later pictures would live on the coarser macroblocks.
  task.vary_quantizers = options.effort == Effort::best && picture.quantizer_map.empty() && !task.is_replaced;
  task.last_vectors = has_last_vectors ? last_vectors.data() : nullptr;
  task.candidates = picture.candidates.data();
  task.candidates_per_macroblock = picture.candidates_per_macroblock;
  if (type == PictureType::P && options.effort != Effort::fast && !picture.prices.empty())
    task.prices = picture.prices.data();
  task.must_be_intra = type == PictureType::P ? forced.data() : nullptr;
  was_replaced = picture.reference != nullptr;
  if (!is_touched && !was_replaced) task.shows_reference = kept.data();
  task.bits_of_difference = bits_of_difference.data();
  task.macroblocks = macroblocks.data();
  return task;
}

void Encoder::State::code_picture(const PictureTask& task) {
  is_touched = true;
  pool.for_each_step(band_rows, [&](int i, int step) {
    Band& band = bands[static_cast<size_t>(i)];
    code_row(task, band, band.first_row + step);
  });
}

PictureReport Encoder::State::write_picture(PictureType type, std::vector<uint8_t>& out) {
  PictureToWrite picture;
  picture.header.type = type;
  picture.header.temporal_reference = temporal_reference & 1023;  // [2.4.3.4]
  picture.columns = columns;
  picture.rows = rows;
  picture.slice_rows = options.slice_rows != 0 ? std::min(options.slice_rows, rows) : rows;
  picture.macroblocks = macroblocks.data();
  if (has_rate) picture.header.vbv_delay = rate.vbv_delay(static_cast<int64_t>(8 * header_bytes));
  if (type == PictureType::P) picture.header.forward_f_code = needed_f_code(picture);
  write_picture_header(picture.header, out);
  pool.for_each(rows, [&](int64_t i) {
    const auto row = static_cast<int>(i);
    const Band& band = *std::find_if(bands.begin(), bands.end(), [&](const Band& b) { return row < b.end_row; });
    write_rows(picture, band.tokens.data(), row, row + 1, bits[static_cast<size_t>(i)]);
  });
  join_rows(bits, out);
  PictureReport report;
  report.type = type;
  for (const Macroblock& macroblock : macroblocks) {
    if (macroblock.kind == MacroblockKind::intra) ++report.intra_macroblocks;
    if (macroblock.kind == MacroblockKind::skipped) ++report.skipped_macroblocks;
    if (macroblock.kind == MacroblockKind::inter && macroblock.pattern != 0) ++report.coded_macroblocks;
  }
  return report;
}

PictureReport Encoder::State::code_at(PictureType type, const PictureOptions& picture, double scale,
                                      std::vector<uint8_t>& out) {
  const double mean = set_quantizers(type, picture, scale);
  code_picture(make_task(type, picture));
  const size_t before = out.size();
  PictureReport report = write_picture(type, out);
  report.quantizer_scale = mean;
  rated_scale = wanted.empty() ? mean : scale;  // before the lookahead's factors
  report.size_bytes = out.size() - before;
  return report;
}

// No coefficients and no motion; the ends of a slice must be coded macroblocks [2.4.4.4].
void Encoder::State::skip_macroblocks() {
  for (Band& band : bands) band.tokens.clear();
  const int slice_rows = options.slice_rows != 0 ? std::min(options.slice_rows, rows) : rows;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      Macroblock& macroblock = macroblocks[static_cast<size_t>(row * columns + column)];
      macroblock = {};
      const bool is_first = column == 0 && row % slice_rows == 0;
      const bool is_last = column == columns - 1 && ((row + 1) % slice_rows == 0 || row + 1 == rows);
      if (is_first || is_last) macroblock.kind = MacroblockKind::inter;
    }
}

PictureReport Encoder::State::skip_everything(const PictureOptions& picture, std::vector<uint8_t>& out) {
  const size_t before = out.size();
  skip_macroblocks();
  set_quantizers(PictureType::P, {}, 31);
  PictureReport report = write_picture(PictureType::P, out);
  fill_planes(view_of(picture.reference != nullptr ? *picture.reference : reference), Planes::of(reconstruction));
  report.quantizer_scale = 31;
  report.size_bytes = out.size() - before;
  return report;
}

// Codes the picture until the caller keeps it.
PictureReport Encoder::State::code_as_told(PictureType type, const PictureOptions& picture, double scale,
                                           std::vector<uint8_t>& out) {
  const size_t before = out.size();
  for (;;) {
    const PictureReport report = code_at(type, picture, scale, out);
    if (picture.code_again == nullptr) return report;
    const double next = picture.code_again(picture.code_again_context, scale, report.size_bytes + header_bytes);
    if (next == 0) return report;
    out.resize(before);
    if (next == kSkipEverything && type == PictureType::P) return skip_everything(picture, out);
    scale = next == kSkipEverything ? 31 : std::clamp(next, 1.0, 31.0);
  }
}

// Codes the picture until its size suits the rate and the decoder's buffer.
PictureReport Encoder::State::code_at_rate(PictureType type, const PictureOptions& picture, std::vector<uint8_t>& out) {
  const size_t before = out.size();
  double scale = rate.first_quantizer();
  for (int tries = 1;; ++tries) {
    const PictureReport report = code_at(type, picture, scale, out);
    const auto size_bits = static_cast<int64_t>(8 * (report.size_bytes + header_bytes));
    const double next = rate.next_quantizer(scale, size_bits, tries);
    if (next == 0) return report;
    scale = next;
    out.resize(before);
  }
}

}  // namespace pac::mpeg1
