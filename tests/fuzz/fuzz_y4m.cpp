// Y4M reader: any bytes give frames, then the end or a failure inside them.
#include <cstddef>
#include <cstdint>

#include "base/y4m.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pac::Limits limits;
  limits.max_pixels = 1 << 20;
  auto reader = pac::Y4mReader::open({data, size}, limits);
  if (!reader.ok()) {
    PAC_ASSERT(reader.failure().byte_offset <= size && reader.failure().text[0] != 0);
    return 0;
  }
  std::vector<uint8_t> written;
  pac::append_y4m_header(written, reader->header());
  pac::Frame420 frame;
  uint64_t n_frames = 0;
  auto more = reader->next(frame);
  for (; more.ok() && *more; more = reader->next(frame)) {
    PAC_ASSERT(frame.width() == reader->header().width && frame.height() == reader->header().height);
    if (n_frames++ < 3) pac::append_y4m_frame(written, frame);
  }
  if (!more.ok()) PAC_ASSERT(more.failure().byte_offset <= size && more.failure().text[0] != 0);
  PAC_ASSERT(n_frames * 6 <= size);  // each frame has at least its header line
  auto again = pac::Y4mReader::open(written, limits);
  PAC_ASSERT(again.ok() && again->header().width == reader->header().width);
  for (uint64_t i = 0; i < n_frames && i < 3; ++i) PAC_ASSERT(again->next(frame).value());
  return 0;
}
