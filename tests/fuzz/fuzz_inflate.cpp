// Inflate: any bytes give a prefix of a stream's contents or a failure, inside a buffer of fixed size; and whatever the
// bytes are, deflate packs them so that inflate gives them back.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/deflate.h"
#include "base/inflate.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  std::vector<uint8_t> out(20000);
  const auto raw = pac::inflate(bytes, out);
  if (raw.ok()) PAC_ASSERT(raw->n_read <= size && raw->n_written <= out.size());
  if (!raw.ok()) PAC_ASSERT(raw.failure().byte_offset <= size && raw.failure().text[0] != 0);
  const auto zlib = pac::inflate_zlib(bytes, out);
  if (!zlib.ok()) PAC_ASSERT(zlib.failure().byte_offset <= size && zlib.failure().text[0] != 0);

  std::vector<uint8_t> again(size);
  const auto packed = pac::deflate_zlib(bytes);
  PAC_ASSERT(packed.size() <= size + size / 4096 + 32);
  const auto sizes = pac::inflate_zlib(packed, again);
  PAC_ASSERT(sizes.ok() && sizes->n_read == packed.size() && sizes->n_written == size);
  for (size_t i = 0; i < size; ++i) PAC_ASSERT(again[i] == data[i]);
  return 0;
}
