// Pictures in order: what type each has, its quantizers, its bands through macroblock_coder and slice_writer.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mpeg1/headers.h"
#include "mpeg1/macroblock_coder.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/slice_writer.h"

namespace pac::mpeg1 {
namespace {

constexpr int kMaxGroupLength = 132;  // no macroblock may be predicted more often [2.4.4.2]
constexpr int kRowsPerBand = 8;

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
  double set_quantizers(const PictureOptions& picture);
  void set_source(const Frame420& frame);
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
  Frame420 source, reconstruction, reference, replaced;  // whole macroblocks
  std::vector<Macroblock> macroblocks;
  std::vector<MotionVector> last_vectors;
  bool has_last_vectors = false;
  std::vector<uint8_t> quantizers;
  std::vector<uint8_t> bits_of_difference;
  std::vector<Band> bands;
  std::vector<BandBits> bits;
  bool in_sequence = false;    // a sequence header was written and no end
  int64_t picture_count = 0;   // of the sequence, for the time code
  int temporal_reference = 0;  // of the next picture in its group
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
  sequence.vbv_buffer_size = o.vbv_buffer_size != 0 ? o.vbv_buffer_size : 1023;
  make_quantizers(sequence.intra_matrix, kIntraRounding, intra);
  make_quantizers(sequence.non_intra_matrix, kNonIntraRounding, non_intra);
  const size_t count = static_cast<size_t>(columns) * static_cast<size_t>(rows);
  macroblocks.resize(count);
  last_vectors.resize(count);
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
  return nullptr;
}

PictureType Encoder::State::choose_type(const PictureOptions& picture) const {
  if (!in_sequence && !(picture.type == PictureType::P && picture.reference != nullptr)) return PictureType::I;
  if (picture.type) return *picture.type;
  return temporal_reference >= options.gop_length ? PictureType::I : PictureType::P;
}

void Encoder::State::start_group(std::vector<uint8_t>& out) {
  write_sequence_header(sequence, out);
  GroupHeader group;
  const int rate = (kPictureRatesMilli[options.picture_rate_code] + 999) / 1000;
  const int64_t seconds = picture_count / rate;
  group.pictures = static_cast<int>(picture_count % rate);
  group.seconds = static_cast<int>(seconds % 60);
  group.minutes = static_cast<int>(seconds / 60 % 60);
  group.hours = static_cast<int>(seconds / 3600 % 24);
  write_group_header(group, out);
  in_sequence = true;
  temporal_reference = 0;
}

// Between integers the first part of the macroblocks has the smaller quantizer: one change of it in the stream.
double Encoder::State::set_quantizers(const PictureOptions& picture) {
  if (!picture.quantizer_map.empty()) {
    std::copy(picture.quantizer_map.begin(), picture.quantizer_map.end(), quantizers.begin());
    double sum = 0;
    for (const uint8_t q : quantizers) sum += q;
    return sum / static_cast<double>(quantizers.size());
  }
  const double scale = picture.quantizer_scale != 0 ? picture.quantizer_scale : options.quantizer_scale;
  const double floor = std::floor(scale);
  const auto finer = static_cast<size_t>((1 - (scale - floor)) * static_cast<double>(quantizers.size()) + 0.5);
  for (size_t i = 0; i < quantizers.size(); ++i)
    quantizers[i] = static_cast<uint8_t>(std::min(31, static_cast<int>(floor) + (i < finer ? 0 : 1)));
  return scale;
}

PictureTask Encoder::State::make_task(PictureType type, const PictureOptions& picture) {
  PictureTask task;
  task.kernels = &kernels;
  task.effort = options.effort;
  task.type = type;
  task.columns = columns;
  task.rows = rows;
  task.slice_rows = options.slice_rows != 0 ? std::min(options.slice_rows, rows) : rows;
  task.source = Planes::of(source);
  task.target = Planes::of(reconstruction);
  task.reference = Planes::of(reference);
  if (type == PictureType::P && picture.reference != nullptr) {
    if (replaced.width() == 0) replaced = Frame420(16 * columns, 16 * rows);
    fill_planes(view_of(*picture.reference), Planes::of(replaced));
    task.reference = Planes::of(replaced);
  }
  task.intra = &intra;
  task.non_intra = &non_intra;
  task.quantizers = quantizers.data();
  task.last_vectors = has_last_vectors ? last_vectors.data() : nullptr;
  task.candidates = picture.candidates.data();
  task.candidates_per_macroblock = picture.candidates_per_macroblock;
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
  picture.header.temporal_reference = temporal_reference;
  picture.columns = columns;
  picture.rows = rows;
  picture.slice_rows = options.slice_rows != 0 ? std::min(options.slice_rows, rows) : rows;
  picture.macroblocks = macroblocks.data();
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
  ++temporal_reference;
  ++picture_count;
}

Result<PictureReport> Encoder::State::add(const Frame420& frame, std::vector<uint8_t>& out,
                                          const PictureOptions& picture) {
  if (const char* problem = problem_with_picture(frame, picture)) return Failure{Error::bad_argument, 0, problem};
  const size_t before = out.size();
  const PictureType type = choose_type(picture);
  if (type == PictureType::I || !in_sequence) start_group(out);
  fill_planes(view_of(frame), Planes::of(source));
  const double scale = set_quantizers(picture);
  code_picture(make_task(type, picture));
  PictureReport report = write_picture(type, out);
  report.quantizer_scale = scale;
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
  for (Band& band : s.bands) band.tokens.clear();
  const int slice_rows = s.options.slice_rows != 0 ? std::min(s.options.slice_rows, s.rows) : s.rows;
  for (int row = 0; row < s.rows; ++row)
    for (int column = 0; column < s.columns; ++column) {
      Macroblock& macroblock = s.macroblocks[static_cast<size_t>(row * s.columns + column)];
      macroblock = {};
      const bool is_first = column == 0 && row % slice_rows == 0;
      const bool is_last = column == s.columns - 1 && ((row + 1) % slice_rows == 0 || row + 1 == s.rows);
      if (is_first || is_last) macroblock.kind = MacroblockKind::inter;
    }
  PictureReport report = s.write_picture(PictureType::P, out);
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
