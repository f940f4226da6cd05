// Packs and packets to an elementary stream [11172-1 2.4.3], and what its headers say.
#include <algorithm>

#include "mpeg1/headers.h"
#include "mpeg1/start_codes.h"
#include "mpeg1/system.h"

namespace pac::mpeg1 {
namespace {

constexpr uint8_t kPack = 0xBA, kSystemHeader = 0xBB, kFirstVideo = 0xE0, kLastVideo = 0xEF;
constexpr size_t kMaxStuffing = 16;

// A time stamp of 33 bits in five bytes with three markers [2.4.3.3].
int64_t read_stamp(std::span<const uint8_t> p) {
  return static_cast<int64_t>(p[0] >> 1 & 7) << 30 | static_cast<int64_t>(p[1]) << 22 |
         static_cast<int64_t>(p[2] >> 1) << 15 | static_cast<int64_t>(p[3]) << 7 | p[4] >> 1;
}

// The packet's header, MPEG-1's or MPEG-2's: its size, or kNotFound where it is wrong. pts -1 where there is none.
size_t packet_header_size(std::span<const uint8_t> packet, int64_t& pts) {
  pts = -1;
  if (packet.size() >= 3 && packet[0] >> 6 == 2) {  // MPEG-2
    const size_t size = size_t{3} + packet[2];
    if (size > packet.size()) return kNotFound;
    if ((packet[1] & 0x80) != 0 && size >= 8) pts = read_stamp(packet.subspan(3));
    return size;
  }
  size_t at = 0;
  while (at < packet.size() && packet[at] == 0xFF && at < kMaxStuffing) ++at;
  if (at + 2 < packet.size() && packet[at] >> 6 == 1) at += 2;  // STD_buffer_size
  if (at >= packet.size()) return kNotFound;
  if (packet[at] == 0x0F) return at + 1;
  const size_t stamps = packet[at] >> 4 == 2 ? 5 : packet[at] >> 4 == 3 ? 10 : 0;
  if (stamps == 0 || at + stamps > packet.size()) return kNotFound;
  pts = read_stamp(packet.subspan(at));
  return at + stamps;
}

class Demultiplexer {
 public:
  explicit Demultiplexer(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  void run() {
    for (size_t at = find_start_code(bytes_, 0); at != kNotFound; at = find_start_code(bytes_, at)) {
      const uint8_t code = bytes_[at + 3];
      if (code == kPack)
        at += at + 4 < bytes_.size() && bytes_[at + 4] >> 6 == 1 ? 14 : 12;
      else if (code >= kSystemHeader)
        at = take_packet(at, code);
      else
        at += 4;  // the end code, or video's own start codes after a broken packet
    }
  }
  SystemStream& result() { return result_; }

 private:
  void error(size_t at) {
    if (result_.errors++ == 0) result_.first_error_offset = at;
  }

  // Where to look for the next start code.
  size_t take_packet(size_t at, uint8_t code) {
    if (at + 6 > bytes_.size()) {
      error(at);
      return bytes_.size();
    }
    const size_t length = static_cast<size_t>(bytes_[at + 4]) << 8 | bytes_[at + 5];
    size_t end = at + 6 + length;
    if (end > bytes_.size()) {
      error(at);
      end = bytes_.size();
    }
    result_.stream_ids_seen[code / 32] |= uint32_t{1} << (code % 32);
    if (code < kFirstVideo || code > kLastVideo) return end;
    if (result_.stream_id == 0) result_.stream_id = code;
    if (code != result_.stream_id) return end;
    int64_t pts = -1;
    const std::span<const uint8_t> packet = bytes_.subspan(at + 6, end - at - 6);
    const size_t header = packet_header_size(packet, pts);
    if (header == kNotFound) {
      error(at);
      return at + 6;
    }
    if (result_.first_pts_90khz < 0) result_.first_pts_90khz = pts;
    ++result_.packets;
    result_.video.insert(result_.video.end(), packet.begin() + static_cast<ptrdiff_t>(header), packet.end());
    return end;
  }

  std::span<const uint8_t> bytes_;
  SystemStream result_;
};

void count_picture(std::span<const uint8_t> payload, StreamInfo& info) {
  const auto picture = parse_picture_header(payload);
  if (!picture.ok()) return;
  ++info.pictures[static_cast<size_t>(picture->type)];
  if (picture->type == PictureType::P)
    info.max_forward_f_code = std::max(info.max_forward_f_code, picture->forward_f_code);
}

}  // namespace

bool is_system_stream(std::span<const uint8_t> bytes) {
  const size_t at = find_start_code(bytes, 0);
  return at != kNotFound && bytes[at + 3] >= kPack;
}

Result<SystemStream> demultiplex(std::span<const uint8_t> bytes, const Limits& limits) {
  if (bytes.size() > limits.max_bytes) return Failure{Error::limit_exceeded, 0, "stream is larger than the limit"};
  Demultiplexer demultiplexer(bytes);
  demultiplexer.run();
  if (demultiplexer.result().packets == 0) return Failure{Error::corrupt, 0, "no video packet in the system stream"};
  return std::move(demultiplexer.result());
}

Result<StreamInfo> read_info(std::span<const uint8_t> video) {
  StreamInfo info;
  Failure problem{Error::corrupt, 0, "no sequence header"};
  bool has_sequence = false;
  uint64_t picture_bytes_at = 0;
  bool last_is_p = false;
  uint64_t slices_of_picture = 0;
  const auto close_picture = [&](uint64_t at) {
    // Slices of a start code, quantizer_scale, two macroblocks and the increments between them: nothing else fits.
    if (last_is_p && slices_of_picture > 0 && at - picture_bytes_at < 10 + 40 * slices_of_picture)
      ++info.repeated_pictures;
    last_is_p = false;
  };
  for (size_t at = find_start_code(video, 0); at != kNotFound;) {
    const uint8_t code = video[at + 3];
    const size_t next = find_start_code(video, at + 4);
    const std::span<const uint8_t> payload = video.subspan(at + 4, std::min(next, video.size()) - at - 4);
    if (code == kPictureStart || code >= kSequenceHeader) close_picture(at);
    if (code == kSequenceHeader) {
      const auto header = parse_sequence_header(payload);
      ++info.sequence_headers;
      if (header.ok() && !has_sequence) info.sequence = *header;
      if (!header.ok() && !has_sequence)
        problem = {header.failure().error, at + 4 + header.failure().byte_offset, header.failure().text};
      has_sequence = has_sequence || header.ok();
    } else if (code == kExtensionStart && has_sequence && info.slices == 0) {
      return Failure{Error::unsupported, at, "MPEG-2 video: extension_start_code"};
    } else if (code == kPictureStart) {
      count_picture(payload, info);
      const auto header = parse_picture_header(payload);
      last_is_p = header.ok() && header->type == PictureType::P;
      picture_bytes_at = at;
      slices_of_picture = 0;
    } else if (code <= kSliceStartLast) {
      ++info.slices;
      ++slices_of_picture;
    } else if (code == kGroupStart) {
      ++info.groups;
    } else if (code == kUserDataStart) {
      info.user_data_bytes += payload.size();
    } else if (code == kSequenceEnd) {
      info.ends = true;
    }
    at = next;
  }
  close_picture(video.size());
  if (!has_sequence) return problem;
  return info;
}

}  // namespace pac::mpeg1
