#include "tests/support/guarded_buffer.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "base/result.h"

namespace pac::test {

GuardedBuffer::GuardedBuffer(size_t capacity) {
  const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
  const size_t inner = (capacity + 64 + page - 1) / page * page;
  mapping_size_ = inner + 2 * page;
  void* mapping = mmap(nullptr, mapping_size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  PAC_ASSERT(mapping != MAP_FAILED);
  mapping_ = static_cast<uint8_t*>(mapping);
  PAC_ASSERT(mprotect(mapping_ + page, inner, PROT_READ | PROT_WRITE) == 0);
  pages_ = {mapping_ + page, inner};
  place(0, Guard::before);
}

GuardedBuffer::~GuardedBuffer() {
  munmap(mapping_, mapping_size_);
}

uint8_t* GuardedBuffer::place(size_t n, Guard guard, size_t shift) {
  PAC_ASSERT(n + shift <= pages_.size());
  data_offset_ = guard == Guard::before ? shift : pages_.size() - n - shift;
  data_size_ = n;
  std::memset(slack_before().data(), kCanary, slack_before().size());
  std::memset(slack_after().data(), kCanary, slack_after().size());
  return pages_.data() + data_offset_;
}

std::span<uint8_t> GuardedBuffer::slack_before() const {
  const size_t n = std::min(data_offset_, kMaxSlack);
  return pages_.subspan(data_offset_ - n, n);
}

std::span<uint8_t> GuardedBuffer::slack_after() const {
  const size_t end = data_offset_ + data_size_;
  return pages_.subspan(end, std::min(pages_.size() - end, kMaxSlack));
}

bool GuardedBuffer::intact() const {
  const auto is_canary = [](uint8_t byte) { return byte == kCanary; };
  const auto before = slack_before(), after = slack_after();
  return std::all_of(before.begin(), before.end(), is_canary) && std::all_of(after.begin(), after.end(), is_canary);
}

}  // namespace pac::test
