// An elementary stream to packs and packets [11172-1 2.4.3, 2.4.5].
#include <algorithm>

#include "mpeg1/headers.h"
#include "mpeg1/start_codes.h"
#include "mpeg1/system.h"

namespace pac::mpeg1 {
namespace {

constexpr size_t kPackBytes = 2048;                    // a CD-ROM sector's data; old players want it so
constexpr size_t kPackHeader = 12, kPacketHeader = 6;  // start codes included
constexpr size_t kSystemHeaderBytes = 15;
constexpr int64_t kClock = 90000;  // Hz
constexpr int kRateUnit = 50;      // bytes a second [mux_rate]
constexpr uint8_t kVideoStream = 0xE0;
constexpr double kLeadSeconds = 0.5;  // no pack is sent earlier than this before its first picture is due

struct Access {
  size_t begin = 0;  // of the picture with the headers before it
};

// Picture boundaries; false where the stream is not ours to multiplex.
Result<std::vector<Access>> find_pictures(std::span<const uint8_t> video, SequenceHeader& sequence) {
  std::vector<Access> pictures;
  bool has_sequence = false;
  size_t pending = kNotFound;  // headers that belong to the next picture
  for (size_t at = find_start_code(video, 0); at != kNotFound; at = find_start_code(video, at + 4)) {
    const uint8_t code = video[at + 3];
    const std::span<const uint8_t> payload = video.subspan(at + 4);
    if ((code == kSequenceHeader || code == kGroupStart) && pending == kNotFound) pending = at;
    if (code == kSequenceHeader && !has_sequence) {
      PAC_TRY(sequence, parse_sequence_header(payload));
      has_sequence = true;
    }
    if (code != kPictureStart) continue;
    if (!has_sequence) return Failure{Error::corrupt, at, "picture before any sequence header"};
    PAC_TRY(const PictureHeader header, parse_picture_header(payload));
    if (header.type == PictureType::B)
      return Failure{Error::unsupported, at, "B pictures are not multiplexed: display order is not coding order"};
    pictures.push_back({pending != kNotFound ? pending : at});
    pending = kNotFound;
  }
  if (pictures.empty()) return Failure{Error::corrupt, 0, "no picture to multiplex"};
  pictures[0].begin = 0;
  return pictures;
}

// 33 bits in five bytes: four bits of prefix, then 3, 15 and 15 bits with a marker after each.
void put_stamp(std::vector<uint8_t>& out, uint32_t prefix, int64_t stamp) {
  const auto t = static_cast<uint64_t>(stamp);
  out.push_back(static_cast<uint8_t>(prefix << 4 | (t >> 30 & 7) << 1 | 1));
  out.push_back(static_cast<uint8_t>(t >> 22));
  out.push_back(static_cast<uint8_t>((t >> 15 & 127) << 1 | 1));
  out.push_back(static_cast<uint8_t>(t >> 7));
  out.push_back(static_cast<uint8_t>((t & 127) << 1 | 1));
}
void put_16(std::vector<uint8_t>& out, size_t value) {
  out.push_back(static_cast<uint8_t>(value >> 8));
  out.push_back(static_cast<uint8_t>(value));
}
void put_rate(std::vector<uint8_t>& out, uint32_t rate) {  // marker, 22 bits, marker
  out.push_back(static_cast<uint8_t>(0x80 | rate >> 15));
  out.push_back(static_cast<uint8_t>(rate >> 7));
  out.push_back(static_cast<uint8_t>((rate & 127) << 1 | 1));
}

class Multiplexer {
 public:
  Multiplexer(std::span<const uint8_t> video, std::vector<Access> pictures, int rate_milli)
      : video_(video), pictures_(std::move(pictures)), rate_milli_(rate_milli) {
    plan();
  }

  std::vector<uint8_t> run() {
    size_t picture = 0;
    for (size_t at = 0; at < video_.size();) {
      const bool is_first = at == 0;
      const size_t system = is_first ? kSystemHeaderBytes : 0, buffer_size = is_first ? 2 : 0;
      while (picture < pictures_.size() && pictures_[picture].begin < at) ++picture;
      // The first picture that begins in the packet gives it its time stamp.
      size_t room = kPackBytes - kPackHeader - system - kPacketHeader - buffer_size - 1;
      bool stamped = picture < pictures_.size() && pictures_[picture].begin < at + room - 4;
      if (stamped) room -= 4;
      const size_t size = std::min(room, video_.size() - at);
      stamped = stamped && pictures_[picture].begin < at + size;
      write_pack_header(picture);
      if (is_first) write_system_header();
      write_start_code(kVideoStream, out_);
      put_16(out_, buffer_size + (stamped ? 5 : 1) + size);
      if (is_first) put_16(out_, 0x4000 | 0x2000 | buffer_kilobytes_);  // '01', scale 1: units of 1024 bytes
      if (stamped)
        put_stamp(out_, 2, due(picture));
      else
        out_.push_back(0x0F);
      out_.insert(out_.end(), video_.begin() + static_cast<ptrdiff_t>(at),
                  video_.begin() + static_cast<ptrdiff_t>(at + size));
      at += size;
    }
    write_start_code(0xB9, out_);
    return std::move(out_);
  }

 private:
  int64_t time_of(size_t picture) const { return static_cast<int64_t>(picture) * kClock * 1000 / rate_milli_; }
  int64_t due(size_t picture) const { return time_of(picture) + delay_; }

  // The rate at which the largest picture takes half a second or the whole stream its own duration times 0.8, whatever
  // is faster; the delay after which every picture is there when it is due; the buffer that holds what waits.
  void plan() {
    size_t largest = 0;
    for (size_t i = 0; i < pictures_.size(); ++i) largest = std::max(largest, end_of(i) - pictures_[i].begin);
    const double seconds = static_cast<double>(time_of(pictures_.size())) / kClock;
    const double overhead = 1.03;  // of 27 bytes in 2048, and rounding
    const double bytes_per_second =
        std::max(static_cast<double>(largest) * 2, static_cast<double>(video_.size()) / seconds * 1.25) * overhead;
    mux_rate_ = static_cast<uint32_t>(std::clamp(bytes_per_second / kRateUnit + 1, 600.0, 4194303.0));
    const double rate = mux_rate_ * static_cast<double>(kRateUnit) / overhead;
    delay_ =
        static_cast<int64_t>((static_cast<double>(largest) / rate + 3.0 * kPackBytes / rate + kLeadSeconds) * kClock);
    // What arrives within the lead and the delay of one picture, at most.
    const double waiting = static_cast<double>(largest) * 2 + rate * kLeadSeconds * 2 + 4 * kPackBytes;
    buffer_kilobytes_ = static_cast<size_t>(std::clamp(waiting / 1024 + 1, 46.0, 8191.0));
  }
  size_t end_of(size_t picture) const {
    return picture + 1 < pictures_.size() ? pictures_[picture + 1].begin : video_.size();
  }

  // A pack leaves when the one before has passed at mux_rate, but not long before its first picture is due.
  void write_pack_header(size_t next_picture) {
    const size_t last = pictures_.size() - 1;
    const int64_t earliest =
        due(std::min(next_picture == 0 ? 0 : next_picture - 1, last)) - delay_;  // the picture under way
    const int64_t passed = clock_ +
                           static_cast<int64_t>(static_cast<double>(out_.size() - sent_) * kClock /
                                                (static_cast<double>(mux_rate_) * kRateUnit)) +
                           1;
    clock_ = out_.empty() ? 0 : std::max(passed, earliest);
    sent_ = out_.size();
    write_start_code(0xBA, out_);
    put_stamp(out_, 2, clock_);
    put_rate(out_, mux_rate_);
  }
  void write_system_header() {
    write_start_code(0xBB, out_);
    put_16(out_, kSystemHeaderBytes - 6);
    put_rate(out_, mux_rate_);
    out_.push_back(0x00);      // audio_bound 0, not fixed, not constrained
    out_.push_back(0x20 | 1);  // no locks, marker, video_bound 1
    out_.push_back(0xFF);      // reserved
    out_.push_back(kVideoStream);
    put_16(out_, 0xC000 | 0x2000 | buffer_kilobytes_);
  }

  std::span<const uint8_t> video_;
  std::vector<Access> pictures_;
  int rate_milli_;
  uint32_t mux_rate_ = 0;
  int64_t delay_ = 0, clock_ = 0;
  size_t buffer_kilobytes_ = 0, sent_ = 0;
  std::vector<uint8_t> out_;
};

}  // namespace

Result<std::vector<uint8_t>> multiplex(std::span<const uint8_t> video) {
  SequenceHeader sequence;
  PAC_TRY(std::vector<Access> pictures, find_pictures(video, sequence));
  return Multiplexer(video, std::move(pictures), kPictureRatesMilli[sequence.picture_rate_code]).run();
}

}  // namespace pac::mpeg1
