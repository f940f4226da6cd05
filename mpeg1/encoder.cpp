// Pictures in order: what type each has, its quantizers, its bands through macroblock_coder and slice_writer.
#include <algorithm>
#include <cmath>

#include "base/kernels/block_kernels.h"
#include "base/parallel.h"
#include "mpeg1/headers.h"
#include "mpeg1/macroblock_coder.h"
#include "mpeg1/motion_search.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/rate_control.h"
#include "mpeg1/slice_writer.h"
#include "mpeg1/trellis.h"

namespace pac::mpeg1 {
namespace {

constexpr int kMaxGroupLength = 132;  // no macroblock may be predicted more often [2.4.4.2]
constexpr int kRowsPerBand = 8;
constexpr double kCutShare = 0.6;  // of intra macroblocks in a P picture, from which on an I picture serves better
constexpr double kFastIntraRounding = 0.375;  // of a step: the trellis rounds to nearest and decides itself

// What a bit may cost in squared error, over quantizer_scale squared. At high rate 6 dB a bit and a uniform error of a
// step (2 quantizer_scale) give 0.46; blocks of few levels want more.
constexpr double kLambda = 0.85;

// I pictures: what quantizer_scale is multiplied by where the macroblock moves and where it stays, how much of it is
// expected to stay before anything was seen, and what lambda is multiplied by.
constexpr double kMovingIntraScale = 0.8, kStillIntraScale = 0.6, kUnknownStillness = 0.3, kIntraLambda = 0.8;

double mix(double a, double b, double share) {
  return a + (b - a) * share;
}

bool is_valid(const std::optional<QuantizerMatrix>& matrix) {
  if (!matrix) return true;
  return std::all_of(matrix->begin(), matrix->end(), [](uint8_t entry) { return entry >= kMinMatrixEntry; });
}

const char* problem_with(const SequenceOptions& o) {
  if (o.width < 1 || o.width > kMaxWidth) return "width is outside 1..4095";
  if (o.height < 1 || o.height > kMaxHeight) return "height is outside 1..2800";
  if (o.picture_rate_code < 1 || o.picture_rate_code > 8) return "picture_rate_code is outside 1..8";
  if (o.pel_aspect_ratio_code < 1 || o.pel_aspect_ratio_code > 14) return "pel_aspect_ratio_code is outside 1..14";
  if (o.gop_length < 1 || o.gop_length > kMaxGroupLength) return "gop_length is outside 1..132";
  if (!(o.quantizer_scale >= 1 && o.quantizer_scale <= 31)) return "quantizer_scale is outside 1..31";
  if (o.bit_rate_bps < 0 || o.bit_rate_bps > 400 * 0x3FFFE) return "bit_rate_bps is outside 0..104856800";
  if (o.vbv_buffer_size < 0 || o.vbv_buffer_size > 1023) return "vbv_buffer_size is outside 0..1023";
  if (o.slice_rows < 0 || o.threads < 0) return "slice_rows or threads is negative";
  if (!is_valid(o.intra_matrix) || !is_valid(o.non_intra_matrix)) return "a matrix entry is below 3";
  if (o.intra_matrix && (*o.intra_matrix)[0] != 8) return "the intra matrix must begin with 8";
  return nullptr;
}

}  // namespace

struct Encoder::State {
  State(const SequenceOptions& o, Isa isa);

  Result<PictureReport> add(const Frame420& frame, std::vector<uint8_t>& out, const PictureOptions& picture);
  const char* problem_with_picture(const Frame420& frame, const PictureOptions& picture) const;
  PictureType choose_type(const PictureOptions& picture) const;
  void start_group(std::vector<uint8_t>& out);
  double set_quantizers(PictureType type, const PictureOptions& picture, double scale);
  double reuse() const;
  double intra_scale(size_t macroblock) const;
  void watch_stillness(PictureType type);
  PictureReport code_at(PictureType type, const PictureOptions& picture, double scale, std::vector<uint8_t>& out);
  PictureReport code_at_rate(PictureType type, const PictureOptions& picture, std::vector<uint8_t>& out);
  PictureReport code_as_told(PictureType type, const PictureOptions& picture, double scale, std::vector<uint8_t>& out);
  void skip_macroblocks();
  PictureReport skip_everything(const PictureOptions& picture, std::vector<uint8_t>& out);
  void account(const PictureReport& report, size_t before, std::vector<uint8_t>& out);
  void age_macroblocks();
  void force_intra();
  void make_lambdas();
  void set_source(const Frame420& frame);
  void set_rate();
  PictureTask make_task(PictureType type, const PictureOptions& picture);
  void code_picture(const PictureTask& task);
  PictureReport write_picture(PictureType type, std::vector<uint8_t>& out);
  void finish_picture(PictureType type);

  SequenceOptions options;
  const Kernels& kernels;
  ThreadPool pool;
  int columns, rows;
  SequenceHeader sequence;
  QuantizerSet intra, non_intra;
  int64_t lambda[2][32] = {};                            // of P and I, each quantizer_scale; see ResidualTask
  Frame420 source, reconstruction, reference, replaced;  // whole macroblocks
  Planes source_planes;                                  // of `source`, or of the caller's frame during add()
  std::vector<Macroblock> macroblocks;
  std::vector<MotionVector> last_vectors;
  bool has_last_vectors = false;
  std::vector<uint8_t> quantizers;
  std::vector<uint8_t> bits_of_difference;
  std::vector<Band> bands;
  std::vector<BandBits> bits;
  bool has_rate = false;
  RateControl rate;
  size_t header_bytes = 0;      // of the sequence and group headers before the picture being coded
  std::vector<uint8_t> ages;    // codings of each macroblock since it was intra
  std::vector<uint8_t> still;   // P pictures of the group that left each macroblock without coefficients
  int n_watched = 0;            // P pictures that `still` counts
  std::vector<uint8_t> forced;  // must be intra
  bool in_sequence = false;     // a sequence header was written and no end
  int64_t picture_count = 0;    // of the sequence, for the time code
  int temporal_reference = 0;   // of the next picture in its group
};

Encoder::State::State(const SequenceOptions& o, Isa isa)
    : options(o),
      kernels(*kernels_for(isa)),
      pool(o.threads),
      columns(macroblock_columns(o.width)),
      rows(macroblock_rows(o.height)),
      source(16 * columns, 16 * rows),
      reconstruction(16 * columns, 16 * rows),
      reference(16 * columns, 16 * rows) {
  sequence.width = o.width;
  sequence.height = o.height;
  sequence.pel_aspect_ratio_code = o.pel_aspect_ratio_code;
  sequence.picture_rate_code = o.picture_rate_code;
  sequence.has_intra_matrix = o.intra_matrix.has_value();
  sequence.has_non_intra_matrix = o.non_intra_matrix.has_value();
  sequence.intra_matrix = o.intra_matrix.value_or(kDefaultIntraMatrix);
  sequence.non_intra_matrix = o.non_intra_matrix.value_or(kDefaultNonIntraMatrix);
  set_rate();
  make_quantizers(sequence.intra_matrix, o.effort == Effort::fast ? kFastIntraRounding : 0.5, intra);
  make_quantizers(sequence.non_intra_matrix, 0.0, non_intra);  // reconstruction lies half a step above the level
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
  bits.resize(bands.size());
  for (int i = 0; i < n_bands; ++i) {
    bands[static_cast<size_t>(i)].first_row = rows * i / n_bands;
    bands[static_cast<size_t>(i)].end_row = rows * (i + 1) / n_bands;
  }
  bits_of_difference.resize(kMaxDifference + 1);
  for (int i = 0; i <= kMaxDifference; ++i)
    bits_of_difference[static_cast<size_t>(i)] = static_cast<uint8_t>(motion_bits(std::min(i, 60), 0, 1));
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

void Encoder::State::make_lambdas() {
  double mean = 0;  // of the matrix, where most levels are
  for (size_t k = 1; k < 16; ++k) mean += sequence.non_intra_matrix[kNaturalFromZigzag[k]] / 15.0;
  for (int q = 1; q < 32; ++q) {
    const double step = q * mean / 16;
    const double of_p = kDistortionScale * kLambda * step * step;
    lambda[0][q] = std::max<int64_t>(1, static_cast<int64_t>(of_p));
    lambda[1][q] = std::max<int64_t>(1, static_cast<int64_t>(of_p * mix(1, kIntraLambda, reuse())));
  }
}

const char* Encoder::State::problem_with_picture(const Frame420& frame, const PictureOptions& picture) const {
  if (frame.width() != options.width || frame.height() != options.height) return "frame has another size";
  if (picture.reference != nullptr &&
      (picture.reference->width() != options.width || picture.reference->height() != options.height))
    return "reference has another size";
  if (picture.type && *picture.type != PictureType::I && *picture.type != PictureType::P)
    return "the encoder writes I and P pictures";
  const size_t count = macroblocks.size();
  if (picture.candidates_per_macroblock < 0 ||
      picture.candidates.size() != count * static_cast<size_t>(picture.candidates_per_macroblock))
    return "not so many candidates as macroblocks ask for";
  if (!picture.quantizer_map.empty() && picture.quantizer_map.size() != count)
    return "quantizer_map has not one entry a macroblock";
  for (const uint8_t q : picture.quantizer_map)
    if (q < 1 || q > 31) return "quantizer_map entry outside 1..31";
  if (picture.quantizer_scale != 0 && !(picture.quantizer_scale >= 1 && picture.quantizer_scale <= 31))
    return "quantizer_scale is outside 1..31";
  if (picture.code_again != nullptr && (has_rate || !picture.quantizer_map.empty()))
    return "code_again decides alone: no constant bit rate and no quantizer_map beside it";
  return nullptr;
}

// A frame of whole macroblocks is read where it is.
void Encoder::State::set_source(const Frame420& frame) {
  source_planes = Planes::of(source);
  if (frame.width() % 16 != 0 || frame.height() % 16 != 0) return fill_planes(view_of(frame), source_planes);
  source_planes = Planes::of(const_cast<Frame420&>(frame));  // only read from
}

PictureType Encoder::State::choose_type(const PictureOptions& picture) const {
  if (!in_sequence && !(picture.type == PictureType::P && picture.reference != nullptr)) return PictureType::I;
  if (picture.type) return *picture.type;
  return temporal_reference >= options.gop_length ? PictureType::I : PictureType::P;
}

void Encoder::State::start_group(std::vector<uint8_t>& out) {
  write_sequence_header(sequence, out);
  GroupHeader group;
  const int pictures_a_second = (kPictureRatesMilli[options.picture_rate_code] + 999) / 1000;
  const int64_t seconds = picture_count / pictures_a_second;
  group.pictures = static_cast<int>(picture_count % pictures_a_second);
  group.seconds = static_cast<int>(seconds % 60);
  group.minutes = static_cast<int>(seconds / 60 % 60);
  group.hours = static_cast<int>(seconds / 3600 % 24);
  write_group_header(group, out);
  in_sequence = true;
  temporal_reference = 0;
}

// How much of an I picture's quality the pictures after it inherit, 0..1: as measured with groups of 15.
double Encoder::State::reuse() const {
  return std::min(1.0, (options.gop_length - 1) / 14.0);
}

// What quantizer_scale is multiplied by in I pictures. The pictures after them repeat their quality and their errors,
// so that a bit there is worth more, the more so the longer the macroblock stays as it is.
double Encoder::State::intra_scale(size_t macroblock) const {
  const double stillness = n_watched > 0 ? static_cast<double>(still[macroblock]) / n_watched : kUnknownStillness;
  return mix(1, mix(kMovingIntraScale, kStillIntraScale, stillness), reuse());
}

// Between integers the first part of the macroblocks has the smaller quantizer: few changes of it in the stream.
double Encoder::State::set_quantizers(PictureType type, const PictureOptions& picture, double scale) {
  const bool is_free = !has_rate && picture.quantizer_scale == 0;
  double sum = 0;
  for (size_t i = 0; i < quantizers.size(); ++i) {
    const double wanted = type == PictureType::I && is_free ? scale * intra_scale(i) : scale;
    const double position = (static_cast<double>(i) + 0.5) / static_cast<double>(quantizers.size());
    quantizers[i] = static_cast<uint8_t>(std::clamp(static_cast<int>(std::floor(wanted + position)), 1, 31));
    if (!picture.quantizer_map.empty()) quantizers[i] = picture.quantizer_map[i];
    sum += quantizers[i];
  }
  const bool is_exact = picture.quantizer_map.empty() && (type == PictureType::P || !is_free);
  return is_exact ? scale : sum / static_cast<double>(quantizers.size());
}

// Long before the limit of 132 codings [2.4.4.2] a macroblock's turn comes: one of kTurns pictures each.
void Encoder::State::force_intra() {
  constexpr int kFirstTurn = 90, kTurns = 32;
  for (size_t i = 0; i < ages.size(); ++i) {
    const bool has_turn = static_cast<int64_t>(i * 7 % kTurns) == picture_count % kTurns;
    forced[i] = options.intra_refresh && (ages[i] >= kMaxGroupLength - 2 || (ages[i] >= kFirstTurn && has_turn));
  }
}

void Encoder::State::watch_stillness(PictureType type) {
  if (type == PictureType::I) {
    std::fill(still.begin(), still.end(), uint8_t{0});
    n_watched = 0;
    return;
  }
  ++n_watched;
  for (size_t i = 0; i < still.size(); ++i)
    if (macroblocks[i].kind != MacroblockKind::intra && macroblocks[i].pattern == 0) ++still[i];
}

void Encoder::State::age_macroblocks() {
  for (size_t i = 0; i < ages.size(); ++i) {
    if (macroblocks[i].kind == MacroblockKind::intra) ages[i] = 0;
    if (macroblocks[i].kind == MacroblockKind::inter && ages[i] < 255) ++ages[i];
  }
}

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
  task.quantizers = quantizers.data();
  task.last_vectors = has_last_vectors ? last_vectors.data() : nullptr;
  task.candidates = picture.candidates.data();
  task.candidates_per_macroblock = picture.candidates_per_macroblock;
  task.must_be_intra = type == PictureType::P ? forced.data() : nullptr;
  task.bits_of_difference = bits_of_difference.data();
  task.macroblocks = macroblocks.data();
  return task;
}

void Encoder::State::code_picture(const PictureTask& task) {
  pool.for_each(static_cast<int64_t>(bands.size()), [&](int64_t i) { code_band(task, bands[static_cast<size_t>(i)]); });
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
  pool.for_each(static_cast<int64_t>(bands.size()),
                [&](int64_t i) { write_band(picture, bands[static_cast<size_t>(i)], bits[static_cast<size_t>(i)]); });
  join_bands(bits, out);
  PictureReport report;
  report.type = type;
  for (const Macroblock& macroblock : macroblocks) {
    if (macroblock.kind == MacroblockKind::intra) ++report.intra_macroblocks;
    if (macroblock.kind == MacroblockKind::skipped) ++report.skipped_macroblocks;
    if (macroblock.kind == MacroblockKind::inter && macroblock.pattern != 0) ++report.coded_macroblocks;
  }
  return report;
}

void Encoder::State::finish_picture(PictureType type) {
  std::swap(reconstruction, reference);  // the next picture's reference, and what reconstruction() shows
  has_last_vectors = type == PictureType::P;
  for (size_t i = 0; i < macroblocks.size(); ++i) last_vectors[i] = macroblocks[i].vector;
  age_macroblocks();
  watch_stillness(type);
  ++temporal_reference;
  ++picture_count;
}

PictureReport Encoder::State::code_at(PictureType type, const PictureOptions& picture, double scale,
                                      std::vector<uint8_t>& out) {
  const double mean = set_quantizers(type, picture, scale);
  code_picture(make_task(type, picture));
  const size_t before = out.size();
  PictureReport report = write_picture(type, out);
  report.quantizer_scale = mean;
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

// After a picture whose headers began at `before`: zero bytes before the next start code, and the books.
void Encoder::State::account(const PictureReport& report, size_t before, std::vector<uint8_t>& out) {
  if (!has_rate) return;
  const auto size_bits = static_cast<int64_t>(8 * (out.size() - before));
  const int64_t stuffing = rate.stuffing_bits(size_bits);
  out.insert(out.end(), static_cast<size_t>(stuffing / 8), 0);
  rate.finish_picture(report.quantizer_scale, size_bits, size_bits + stuffing);
}

Result<PictureReport> Encoder::State::add(const Frame420& frame, std::vector<uint8_t>& out,
                                          const PictureOptions& picture) {
  if (const char* problem = problem_with_picture(frame, picture)) return Failure{Error::bad_argument, 0, problem};
  const size_t before = out.size();
  set_source(frame);
  const bool free_quantizer = picture.quantizer_map.empty() && picture.quantizer_scale == 0;
  PictureType type = choose_type(picture);
  force_intra();
  PictureReport report;
  bool is_new_group = false;  // also when the picture is coded again
  for (;;) {
    out.resize(before);
    const bool starts_group = type == PictureType::I || !in_sequence || is_new_group;
    is_new_group = starts_group;
    if (starts_group) start_group(out);
    header_bytes = out.size() - before;
    if (has_rate) rate.start_picture(type);
    const double scale = picture.quantizer_scale != 0 ? picture.quantizer_scale : options.quantizer_scale;
    report = has_rate && free_quantizer ? code_at_rate(type, picture, out) : code_as_told(type, picture, scale, out);
    const bool is_cut = type == PictureType::P && options.scene_cuts && !picture.type &&
                        report.intra_macroblocks > kCutShare * static_cast<double>(macroblocks.size());
    if (!is_cut) break;
    type = PictureType::I;
  }
  account(report, before, out);
  report.size_bytes = out.size() - before;
  finish_picture(type);
  return report;
}

Encoder::Encoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

Result<Encoder> Encoder::create(const SequenceOptions& options, Isa isa) {
  if (const char* problem = problem_with(options)) return Failure{Error::bad_argument, 0, problem};
  if (static_cast<uint64_t>(options.width) * static_cast<uint64_t>(options.height) > options.limits.max_pixels)
    return Failure{Error::limit_exceeded, 0, "pictures have more pixels than the limit"};
  return Encoder(std::make_unique<State>(options, isa));
}

Result<PictureReport> Encoder::add(const Frame420& frame, std::vector<uint8_t>& out, const PictureOptions& options) {
  return state_->add(frame, out, options);
}

Result<PictureReport> Encoder::repeat(std::vector<uint8_t>& out) {
  State& s = *state_;
  if (!s.in_sequence) return Failure{Error::bad_argument, 0, "there is no picture to repeat"};
  const size_t before = out.size();
  s.skip_macroblocks();
  s.header_bytes = 0;
  if (s.has_rate) s.rate.start_picture(PictureType::P);
  PictureReport report = s.write_picture(PictureType::P, out);
  s.account(report, before, out);
  report.size_bytes = out.size() - before;
  fill_planes(view_of(s.reference), Planes::of(s.reconstruction));
  s.finish_picture(PictureType::P);
  return report;
}

void Encoder::finish(std::vector<uint8_t>& out) {
  write_start_code(kSequenceEnd, out);
  state_->in_sequence = false;
}

FrameView Encoder::reconstruction() const {
  const Frame420& frame = state_->reference;
  FrameView view = view_of(frame);
  view.y.width = state_->options.width;
  view.y.height = state_->options.height;
  view.cb.width = view.cr.width = (state_->options.width + 1) / 2;
  view.cb.height = view.cr.height = (state_->options.height + 1) / 2;
  return view;
}

}  // namespace pac::mpeg1
