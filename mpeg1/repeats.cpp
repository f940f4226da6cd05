#include "mpeg1/repeats.h"

#include "mpeg1/headers.h"
#include "mpeg1/slice_writer.h"
#include "mpeg1/start_codes.h"

namespace pac::mpeg1 {
namespace {

constexpr int kVariableRate = 0x3FFFF;

class Repeater {
 public:
  explicit Repeater(int rate_milli) : rate_milli_(static_cast<uint64_t>(rate_milli)) {}

  // A unit with its start code; `offset` in the stream.
  Result<void> take(std::span<const uint8_t> unit, uint64_t offset) {
    const uint8_t code = unit[3];
    const bool ends_picture = code == kPictureStart || code >= kUserDataStart;
    if (ends_picture && in_picture_) finish_picture();
    if (code == kSequenceEnd) return {};  // finish() writes it
    if (code == kSequenceHeader) PAC_CHECK(take_sequence(unit.subspan(4), offset));
    if (code == kGroupStart) return take_group(unit.subspan(4), offset);
    if (code == kPictureStart) return take_picture(unit, offset);
    out_.insert(out_.end(), unit.begin(), unit.end());
    return {};
  }

  std::vector<uint8_t> finish() {
    if (in_picture_) finish_picture();
    write_start_code(kSequenceEnd, out_);
    return std::move(out_);
  }

 private:
  Result<void> take_sequence(std::span<const uint8_t> payload, uint64_t offset) {
    PAC_TRY(sequence_, parse_sequence_header(payload));
    if (sequence_.bit_rate != kVariableRate)
      return Failure{Error::unsupported, offset, "a stream of constant bit rate has no room for repeated pictures"};
    make_repeat();
    return {};
  }

  // The first and the last macroblock of the only slice; the others are skipped [2.4.4.4].
  void make_repeat() {
    const int columns = macroblock_columns(sequence_.width), rows = macroblock_rows(sequence_.height);
    std::vector<Macroblock> macroblocks(static_cast<size_t>(columns) * static_cast<size_t>(rows));
    macroblocks.front().kind = macroblocks.back().kind = MacroblockKind::inter;
    PictureToWrite picture;
    picture.header.type = PictureType::P;
    picture.columns = columns;
    picture.rows = picture.slice_rows = rows;
    picture.macroblocks = macroblocks.data();
    RowBits bits;
    write_rows(picture, nullptr, 0, rows, bits);
    repeat_slice_.clear();
    join_rows({&bits, 1}, repeat_slice_);
  }

  Result<void> take_group(std::span<const uint8_t> payload, uint64_t offset) {
    auto group = parse_group_header(payload);
    if (!group.ok()) return Failure{group.failure().error, offset, group.failure().text};
    const int a_second = (kPictureRatesMilli[sequence_.picture_rate_code] + 999) / 1000;
    const auto seconds = n_written_ / static_cast<uint64_t>(a_second);
    group->pictures = static_cast<int>(n_written_ % static_cast<uint64_t>(a_second));
    group->seconds = static_cast<int>(seconds % 60);
    group->minutes = static_cast<int>(seconds / 60 % 60);
    group->hours = static_cast<int>(seconds / 3600 % 24);
    write_group_header(*group, out_);
    temporal_reference_ = 0;
    return {};
  }

  // temporal_reference is the header's first 10 bits.
  Result<void> take_picture(std::span<const uint8_t> unit, uint64_t offset) {
    const auto header = parse_picture_header(unit.subspan(4));
    if (!header.ok()) return Failure{header.failure().error, offset, header.failure().text};
    if (repeat_slice_.empty()) return Failure{Error::corrupt, offset, "picture before any sequence header"};
    if (header->type != PictureType::I && header->type != PictureType::P)
      return Failure{Error::unsupported, offset, "only I and P pictures can be repeated"};
    const size_t at = out_.size() + 4;
    out_.insert(out_.end(), unit.begin(), unit.end());
    const unsigned number = temporal_reference_++ & 1023;
    out_[at] = static_cast<uint8_t>(number >> 2);
    out_[at + 1] = static_cast<uint8_t>((out_[at + 1] & 63u) | (number & 3) << 6);
    in_picture_ = true;
    return {};
  }

  void finish_picture() {
    in_picture_ = false;
    ++n_written_;
    ++n_source_;
    for (; is_repeat_due(n_written_, n_source_, rate_milli_, sequence_.picture_rate_code); ++n_written_) {
      PictureHeader header;
      header.type = PictureType::P;
      header.temporal_reference = static_cast<int>(temporal_reference_++ & 1023);
      write_picture_header(header, out_);
      out_.insert(out_.end(), repeat_slice_.begin(), repeat_slice_.end());
    }
  }

  uint64_t rate_milli_;
  SequenceHeader sequence_;
  std::vector<uint8_t> out_, repeat_slice_;
  uint64_t n_written_ = 0, n_source_ = 0;
  unsigned temporal_reference_ = 0;
  bool in_picture_ = false;
};

}  // namespace

Result<std::vector<uint8_t>> with_repeats(std::span<const uint8_t> video, int rate_milli) {
  if (rate_milli < 1) return Failure{Error::bad_argument, 0, "a rate below a thousandth"};
  Repeater repeater(rate_milli);
  size_t at = find_start_code(video, 0);
  if (at == kNotFound) return Failure{Error::corrupt, 0, "no start code"};
  while (at != kNotFound) {
    const size_t next = find_start_code(video, at + 4);
    const size_t end = next == kNotFound ? video.size() : next;
    PAC_CHECK(repeater.take(video.subspan(at, end - at), at));
    at = next;
  }
  return repeater.finish();
}

}  // namespace pac::mpeg1
