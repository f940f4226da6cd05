// Units of the stream in order: headers change the state, slices reconstruct, the end of a picture conceals and orders.
#include <algorithm>
#include <cstring>
#include <utility>

#include "mpeg1/headers.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/predict.h"
#include "mpeg1/slice_reader.h"
#include "mpeg1/start_codes.h"

namespace pac::mpeg1 {
namespace {

// A reference picture, or the one being decoded, in whole macroblocks.
struct Picture {
  Frame420 samples;
  PictureHeader header;
  uint64_t byte_offset = 0;
  int concealed = 0;
};

bool is_reference(PictureType type) {
  return type == PictureType::I || type == PictureType::P;
}

FrameView cropped(const Frame420& frame, int width, int height) {
  const auto crop = [](PlaneView<const uint8_t> plane, int w, int h) {
    plane.width = w;
    plane.height = h;
    return plane;
  };
  const int chroma_width = (width + 1) / 2, chroma_height = (height + 1) / 2;
  return {crop(frame.y.view(), width, height), crop(frame.cb.view(), chroma_width, chroma_height),
          crop(frame.cr.view(), chroma_width, chroma_height)};
}

void fill_gray(Frame420& frame) {
  for (GrayImage* plane : {&frame.y, &frame.cb, &frame.cr})
    for (int y = 0; y < plane->height(); ++y) std::memset(plane->row(y), 128, static_cast<size_t>(plane->width()));
}

}  // namespace

struct Decoder::State {
  explicit State(const DecoderOptions& o, Isa isa) : options(o), kernels(*kernels_for(isa)) {}

  Result<const DecodedPicture*> next();
  Result<void> step(bool& needs_more);
  Result<void> take_unit(uint8_t code, std::span<const uint8_t> payload);
  Result<void> take_sequence(std::span<const uint8_t> payload);
  Result<void> take_picture(std::span<const uint8_t> payload);
  Result<void> start_picture(const PictureHeader& header);
  Result<void> take_slice(uint8_t code, std::span<const uint8_t> payload);
  Result<void> complete_picture();
  Result<void> violation(Failure failure);
  bool choose_references(const PictureHeader& header, Planes& forward, Planes& backward);
  void conceal();
  void deliver(Picture& picture);
  Picture& in_work() { return is_reference(context.header.type) ? references[0] : spare; }
  void forget_pictures();
  uint64_t offset_of(size_t position) const { return discarded + position; }

  DecoderOptions options;
  const Kernels& kernels;
  ErrorReport report;
  bool failed = false;
  Failure failure;

  std::vector<uint8_t> buffer;  // fed and not yet dropped
  size_t at = 0;                // in buffer: the next unit's start code, or where to look for one
  size_t searched = 0;          // no start code begins in [at + 1, searched)
  uint64_t discarded = 0;       // bytes of the stream before buffer[0]
  bool in_unit = false;         // at is on a start code
  bool flushing = false;        // what is in the buffer is complete up to its end
  bool finished = false;        // ... and the stream is over

  bool has_sequence = false;
  SequenceHeader sequence;
  Dequantizer intra, non_intra;
  bool group_is_closed = false, group_is_broken = false;
  int pictures_since_group = 0;

  // references[1] is the newest. The next reference picture, which needs no other, is decoded into references[0]; B and
  // D pictures into spare.
  Picture references[2], spare;
  Frame420 replaced;  // the caller's reference, in whole macroblocks
  int n_references = 0;
  bool waits_for_output = false;  // references[1] has not been delivered
  bool in_picture = false;        // slices belong to in_work()
  PictureContext context;
  SliceReader reader{context};
  std::vector<uint8_t> covered;
  std::vector<uint8_t> last_covered;  // of references[1]: where it is a copy of references[0]
  bool has_output = false;
  DecodedPicture output;
};

Result<void> Decoder::State::violation(Failure what) {
  if (report.errors++ == 0) report.first = what;
  if (options.strict) return what;
  return {};
}

void Decoder::State::forget_pictures() {
  n_references = 0;
  last_covered.clear();
  waits_for_output = in_picture = false;
}

Result<void> Decoder::State::take_sequence(std::span<const uint8_t> payload) {
  auto parsed = parse_sequence_header(payload);
  if (!parsed.ok()) {
    Failure what = parsed.failure();
    what.byte_offset += offset_of(at) + 4;
    if (what.error == Error::unsupported) return what;
    return violation(what);
  }
  const bool same_size = has_sequence && parsed->width == sequence.width && parsed->height == sequence.height;
  if (!same_size) {
    const uint64_t pixels = static_cast<uint64_t>(parsed->width) * static_cast<uint64_t>(parsed->height);
    if (pixels > options.limits.max_pixels)
      return Failure{Error::limit_exceeded, offset_of(at), "pictures have more pixels than the limit"};
    if (waits_for_output) deliver(references[1]);
    forget_pictures();
  }
  if (!has_sequence || parsed->intra_matrix != sequence.intra_matrix)
    make_dequantizer(parsed->intra_matrix, true, intra);
  if (!has_sequence || parsed->non_intra_matrix != sequence.non_intra_matrix)
    make_dequantizer(parsed->non_intra_matrix, false, non_intra);
  sequence = *parsed;
  has_sequence = true;
  return {};
}

// False: the references that the picture needs are not there.
bool Decoder::State::choose_references(const PictureHeader& header, Planes& forward, Planes& backward) {
  if (header.type == PictureType::P) {
    if (options.reference != nullptr) {
      const FrameView last =
          n_references > 0 ? cropped(references[1].samples, sequence.width, sequence.height) : FrameView{};
      const Frame420* given = options.reference(options.reference_context, header, last);
      if (given != nullptr) {
        PAC_ASSERT(given->width() == sequence.width && given->height() == sequence.height);
        forward = whole_macroblocks(*given, replaced);
        context.skipped = kCopied;
        return true;
      }
    }
    if (n_references == 0) return false;
    forward = Planes::of(references[1].samples);
  }
  if (header.type == PictureType::B) {
    if (n_references == 0) return false;
    backward = Planes::of(references[1].samples);
    if (n_references == 1 && !group_is_closed) return false;
    if (group_is_broken && pictures_since_group == 1) return false;  // needs what was cut away
    forward = n_references == 1 ? backward : Planes::of(references[0].samples);
  }
  return true;
}

Result<void> Decoder::State::take_picture(std::span<const uint8_t> payload) {
  if (!has_sequence) return violation({Error::corrupt, offset_of(at), "picture before any sequence header"});
  auto header = parse_picture_header(payload);
  if (!header.ok()) {
    ++report.dropped_pictures;
    Failure what = header.failure();
    what.byte_offset += offset_of(at) + 4;
    return violation(what);
  }
  return start_picture(*header);
}

Result<void> Decoder::State::start_picture(const PictureHeader& header) {
  const int columns = macroblock_columns(sequence.width), rows = macroblock_rows(sequence.height);
  for (Picture* picture : {&references[0], &references[1], &spare}) {
    if (picture == &spare && is_reference(header.type)) continue;
    if (picture->samples.width() == 16 * columns && picture->samples.height() == 16 * rows) continue;
    picture->samples = Frame420(16 * columns, 16 * rows);
  }
  if (is_reference(header.type)) ++pictures_since_group;
  context = PictureContext{};
  if (!choose_references(header, context.forward, context.backward)) {
    ++report.dropped_pictures;
    return violation({Error::corrupt, offset_of(at), "picture without its reference pictures"});
  }
  context.kernels = &kernels.motion;
  context.header = header;
  Picture& picture = in_work();
  picture.header = header;
  picture.byte_offset = offset_of(at);
  picture.concealed = 0;
  context.columns = columns;
  context.rows = rows;
  context.target = Planes::of(picture.samples);
  context.intra = &intra;
  context.non_intra = &non_intra;
  context.covered = &covered;
  covered.assign(static_cast<size_t>(columns) * static_cast<size_t>(rows), kMissing);
  if (header.type == PictureType::P && context.forward.data[0] == references[1].samples.y.row(0)) {
    context.skipped = kKept;
    if (last_covered.size() == covered.size()) context.kept_before = last_covered.data();
  }
  reader.start_picture();
  in_picture = true;
  return {};
}

Result<void> Decoder::State::take_slice(uint8_t code, std::span<const uint8_t> payload) {
  if (!in_picture) {
    if (report.dropped_pictures > 0) return {};  // of a picture that was dropped
    return violation({Error::corrupt, offset_of(at), "slice outside a picture"});
  }
  if (code > context.rows)
    return violation({Error::corrupt, offset_of(at), "slice_vertical_position below the picture"});
  const char* problem = reader.read(payload, code - 1);
  if (problem == nullptr) return {};
  const uint64_t inside = std::min<uint64_t>(reader.byte_offset(), payload.size());
  return violation({Error::corrupt, offset_of(at) + 4 + inside, problem});
}

// Macroblocks that no slice delivered: what is at their place in the reference picture.
void Decoder::State::conceal() {
  Planes source = context.forward;
  Frame420 gray;
  if (source.data[0] == nullptr) {
    if (n_references > 0) {
      source = Planes::of(references[1].samples);
    } else {
      gray = Frame420(in_work().samples.width(), in_work().samples.height());
      fill_gray(gray);
      source = Planes::of(gray);
    }
  }
  for (size_t i = 0; i < covered.size(); ++i) {
    if (covered[i] != kMissing) continue;
    const int address = static_cast<int>(i);
    copy_macroblocks(source, address % context.columns, address / context.columns, 1, context.target);
    ++in_work().concealed;
  }
  report.concealed_macroblocks += static_cast<uint64_t>(in_work().concealed);
}

void Decoder::State::deliver(Picture& picture) {
  output.view = cropped(picture.samples, sequence.width, sequence.height);
  output.header = picture.header;
  output.byte_offset = picture.byte_offset;
  output.concealed_macroblocks = picture.concealed;
  output.macroblocks = {};
  has_output = true;
}

// Display order [2.4.4, decoding process]: a reference picture comes out when the next one is complete, the others at
// once.
Result<void> Decoder::State::complete_picture() {
  in_picture = false;
  if (std::find(covered.begin(), covered.end(), uint8_t{kMissing}) != covered.end()) {
    conceal();
    PAC_CHECK(violation({Error::corrupt, in_work().byte_offset, "macroblocks are missing"}));
  }
  if (!is_reference(context.header.type)) {
    deliver(spare);
    return {};
  }
  std::swap(references[0], references[1]);
  std::swap(covered, last_covered);
  n_references = std::min(n_references + 1, 2);
  if (options.low_delay) {
    deliver(references[1]);
    if (context.skipped == kCopied) output.macroblocks = last_covered;
    return {};
  }
  if (waits_for_output) deliver(references[0]);
  waits_for_output = true;
  return {};
}

Result<void> Decoder::State::take_unit(uint8_t code, std::span<const uint8_t> payload) {
  if (code >= kSliceStartFirst && code <= kSliceStartLast) return take_slice(code, payload);
  switch (code) {
    case kPictureStart:
      return take_picture(payload);
    case kSequenceHeader:
      return take_sequence(payload);
    case kGroupStart: {
      auto group = parse_group_header(payload);
      if (!group.ok()) return violation({group.failure().error, offset_of(at), group.failure().text});
      group_is_closed = group->closed;
      group_is_broken = group->broken_link;
      pictures_since_group = 0;
      return {};
    }
    case kUserDataStart:
      return {};
    case kSequenceEnd:
      if (waits_for_output) deliver(references[1]);
      waits_for_output = false;
      return {};
    case kExtensionStart:
      return Failure{Error::unsupported, offset_of(at), "MPEG-2 video: extension_start_code"};
    case kSequenceError:
      return violation({Error::corrupt, offset_of(at), "sequence_error_code"});
    default:
      if (code >= kSystemStartFirst)
        return Failure{Error::unsupported, offset_of(at), "system start code in an elementary video stream"};
      return {};  // reserved
  }
}

// One unit, or the end of a picture before it.
Result<void> Decoder::State::step(bool& needs_more) {
  const std::span<const uint8_t> bytes(buffer);
  if (!in_unit) {
    const size_t found = find_start_code(bytes, at);
    if (found == kNotFound) {
      needs_more = true;
      at = std::max(at, bytes.size() < 3 ? size_t{0} : bytes.size() - 3);
    } else {
      at = found;
      searched = at + 4;
      in_unit = true;
    }
    return {};
  }
  const uint8_t code = bytes[at + 3];
  const bool ends_picture = code == kPictureStart || code >= kSequenceHeader;
  if (in_picture && ends_picture && code != kExtensionStart) return complete_picture();
  size_t end = find_start_code(bytes, searched);
  if (end == kNotFound) {
    if (!flushing) {
      searched = std::max(searched, bytes.size() < 3 ? size_t{0} : bytes.size() - 3);
      needs_more = true;
      return {};
    }
    end = bytes.size();
  }
  PAC_CHECK(take_unit(code, bytes.subspan(at + 4, end - at - 4)));
  in_unit = false;
  at = end;
  return {};
}

Result<const DecodedPicture*> Decoder::State::next() {
  has_output = false;
  while (!failed) {
    bool needs_more = false;
    auto done = step(needs_more);
    if (!done.ok()) {
      failed = true;
      failure = done.failure();
      if (report.errors == 0) report.errors = 1, report.first = failure;
      break;
    }
    if (has_output) return &output;
    if (!needs_more) continue;
    if (flushing && in_picture) {
      auto completed = complete_picture();
      if (!completed.ok()) {
        failed = true;
        failure = completed.failure();
        break;
      }
      if (has_output) return &output;
    }
    flushing = false;
    if (finished && waits_for_output) {
      waits_for_output = false;
      deliver(references[1]);
      return &output;
    }
    return nullptr;
  }
  return failure;
}

Decoder::Decoder(const DecoderOptions& options, Isa isa) : state_(std::make_unique<State>(options, isa)) {}
Decoder::~Decoder() = default;
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;

void Decoder::feed(std::span<const uint8_t> bytes) {
  State& s = *state_;
  s.finished = s.flushing = false;
  if (s.at > s.buffer.size() / 2) {  // drop what is behind us, at a cost below that of copying what came
    s.buffer.erase(s.buffer.begin(), s.buffer.begin() + static_cast<ptrdiff_t>(s.at));
    s.discarded += s.at;
    s.searched -= std::min(s.searched, s.at);
    s.at = 0;
  }
  if (s.buffer.size() + bytes.size() > s.options.limits.max_bytes && !s.failed) {
    s.failed = true;
    s.failure = {Error::limit_exceeded, s.offset_of(s.buffer.size()), "more bytes wait than the limit"};
  }
  if (!s.failed) s.buffer.insert(s.buffer.end(), bytes.begin(), bytes.end());
}

void Decoder::end_picture() {
  state_->flushing = true;
}

void Decoder::finish() {
  state_->flushing = state_->finished = true;
}

Result<const DecodedPicture*> Decoder::next() {
  return state_->next();
}

const SequenceHeader* Decoder::sequence() const {
  return state_->has_sequence ? &state_->sequence : nullptr;
}

const ErrorReport& Decoder::report() const {
  return state_->report;
}

}  // namespace pac::mpeg1
