// Pictures in order: what type each has, where groups start, what is remembered from one to the next.
#include <algorithm>

#include "mpeg1/encoder_state.h"

namespace pac::mpeg1 {
namespace {

constexpr double kCutShare = 0.6;  // of intra macroblocks in a P picture, from which on an I picture serves better

}  // namespace

PictureType Encoder::State::choose_type(const PictureOptions& picture) const {
  if (!in_sequence && !(picture.type == PictureType::P && picture.reference != nullptr)) return PictureType::I;
  if (picture.type) return *picture.type;
  return temporal_reference >= options.gop_length ? PictureType::I : PictureType::P;
}

void Encoder::State::start_group(std::vector<uint8_t>& out) {
  if (in_sequence) adapt_matrices();
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

// From the group's first picture on.
void Encoder::State::look_ahead(const Frame420& frame, const PictureOptions& picture) {
  lookahead.forget();
  frame_in_group = 0;
  if (has_rate) rate.start_group(1, 1);
  if (picture.following.empty()) return;
  const auto most = static_cast<size_t>(options.gop_length - 1);
  lookahead.look(frame, picture.following.first(std::min(most, picture.following.size())),
                 has_rate ? rate.usual_quantizer() : options.quantizer_scale, bands, kernels.motion, pool);
  if (has_rate) rate.start_group(lookahead.finer(0), lookahead.finer_on_average(options.gop_length));
}

// Long before the limit of 132 codings [2.4.4.2] a macroblock's turn comes: one of kTurns pictures each.
void Encoder::State::force_intra() {
  constexpr int kFirstTurn = 90, kTurns = 32;
  for (size_t i = 0; i < ages.size(); ++i) {
    const bool has_turn = static_cast<int64_t>(i * 7 % kTurns) == picture_count % kTurns;
    forced[i] = options.intra_refresh && (ages[i] >= kMaxGroupLength - 2 || (ages[i] >= kFirstTurn && has_turn));
  }
}

void Encoder::State::age_macroblocks() {
  for (size_t i = 0; i < ages.size(); ++i) {
    if (macroblocks[i].kind == MacroblockKind::intra) ages[i] = 0;
    if (macroblocks[i].kind == MacroblockKind::inter && ages[i] < 255) ++ages[i];
  }
}

// What a picture left as it was need not be copied when the next but one leaves it, too.
void Encoder::State::note_kept(PictureType type) {
  kept.resize(macroblocks.size());
  for (size_t i = 0; i < kept.size(); ++i) {
    const Macroblock& m = macroblocks[i];
    const bool is_kept = m.kind != MacroblockKind::intra && m.pattern == 0 && m.vector == MotionVector{};
    kept[i] = type == PictureType::P && !was_replaced && is_kept ? 1 : 0;
  }
  is_touched = false;
}

void Encoder::State::finish_picture(PictureType type) {
  std::swap(reconstruction, reference);  // the next picture's reference, and what reconstruction() shows
  has_last_vectors = type == PictureType::P;
  for (size_t i = 0; i < macroblocks.size(); ++i) last_vectors[i] = macroblocks[i].vector;
  coarse.finish_picture();
  age_macroblocks();
  watch_stillness(type);
  note_kept(type);
  ++temporal_reference;
  ++picture_count;
}

// After a picture whose headers began at `before`: zero bytes before the next start code, and the books.
void Encoder::State::account(size_t before, std::vector<uint8_t>& out) {
  if (!has_rate) return;
  const auto size_bits = static_cast<int64_t>(8 * (out.size() - before));
  const int64_t stuffing = rate.stuffing_bits(size_bits);
  out.insert(out.end(), static_cast<size_t>(stuffing / 8), 0);
  rate.finish_picture(rated_scale, size_bits, size_bits + stuffing);
}

Result<PictureReport> Encoder::State::add(const Frame420& frame, std::vector<uint8_t>& out,
                                          const PictureOptions& picture) {
  if (const char* problem = problem_with_picture(frame, picture)) return Failure{Error::bad_argument, 0, problem};
  const size_t before = out.size();
  source_planes = whole_macroblocks(frame, source);
  if (options.effort != Effort::fast) coarse.start_picture(source_planes, kernels.motion, pool);
  const bool free_quantizer = picture.quantizer_map.empty() && picture.quantizer_scale == 0;
  PictureType type = choose_type(picture);
  force_intra();
  PictureReport report;
  bool is_new_group = false;  // also when the picture is coded again
  for (;;) {
    out.resize(before);
    const bool starts_group = type == PictureType::I || !in_sequence || is_new_group;
    is_new_group = starts_group;
    if (!in_sequence && type == PictureType::I) flatten_intra_matrix();
    if (starts_group) start_group(out);
    if (starts_group) look_ahead(frame, picture);
    header_bytes = out.size() - before;
    if (has_rate) rate.start_picture(type, lookahead.finer(frame_in_group));
    const double scale =
        picture.quantizer_scale != 0 ? picture.quantizer_scale : std::max(1.0, options.quantizer_scale);
    report = has_rate && free_quantizer ? code_at_rate(type, picture, out) : code_as_told(type, picture, scale, out);
    const bool is_cut = type == PictureType::P && options.scene_cuts && !picture.type &&
                        report.intra_macroblocks > kCutShare * static_cast<double>(macroblocks.size());
    if (!is_cut) break;
    type = PictureType::I;
  }
  account(before, out);
  report.size_bytes = out.size() - before;
  finish_picture(type);
  ++frame_in_group;
  return report;
}

Result<PictureReport> Encoder::add(const Frame420& frame, std::vector<uint8_t>& out, const PictureOptions& options) {
  return state_->add(frame, out, options);
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

Result<PictureReport> Encoder::repeat(std::vector<uint8_t>& out) {
  State& s = *state_;
  if (!s.in_sequence) return Failure{Error::bad_argument, 0, "there is no picture to repeat"};
  const size_t before = out.size();
  s.skip_macroblocks();
  s.header_bytes = 0;
  if (s.has_rate) s.rate.start_picture(PictureType::P, 1);
  PictureReport report = s.write_picture(PictureType::P, out);
  s.rated_scale = 0;
  s.account(before, out);
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
