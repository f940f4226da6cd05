// System streams [ISO/IEC 11172-1]: video out of packs and packets, and into them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

// The bytes begin, after any zeros or garbage, with a pack (also of MPEG-2's program streams) rather than with video.
bool is_system_stream(std::span<const uint8_t> bytes);

struct SystemStream {
  std::vector<uint8_t> video;        // the elementary stream of the first video stream met
  int stream_id = 0;                 // 0xE0..0xEF
  uint32_t stream_ids_seen[8] = {};  // bit id % 32 of word id / 32
  int64_t first_pts_90khz = -1;      // -1: none told
  uint64_t packets = 0;              // of the video stream
  uint64_t errors = 0;               // broken or cut packets; what could be read of them is in `video`
  uint64_t first_error_offset = 0;
};

// Fails with corrupt where there is no video packet at all, limit_exceeded past limits.max_bytes.
Result<SystemStream> demultiplex(std::span<const uint8_t> bytes, const Limits& limits = {});

// An elementary stream of I and P pictures (display order is coding order) as a system stream: packs of at most 2048
// bytes with a time stamp for each picture that begins in them, a decoder's buffer that never runs empty, end code.
// Fails with corrupt where the stream has no sequence header or no picture, unsupported where it has B pictures.
Result<std::vector<uint8_t>> multiplex(std::span<const uint8_t> video);

// What the headers of an elementary stream say; the pictures are not decoded.
struct StreamInfo {
  SequenceHeader sequence;    // the first
  uint64_t pictures[5] = {};  // by PictureType
  uint64_t sequence_headers = 0, groups = 0, slices = 0, user_data_bytes = 0;
  uint64_t repeated_pictures = 0;  // P pictures of skipped macroblocks only: each macroblock row costs nothing
  int max_forward_f_code = 0;
  bool ends = false;  // with sequence_end_code
};
// Fails where no sequence header can be read.
Result<StreamInfo> read_info(std::span<const uint8_t> video);

}  // namespace pac::mpeg1
