// Memory that stops the program when a kernel reads or writes one byte too far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pac::test {

// The side of the data that touches an inaccessible page.
enum class Guard : uint8_t { before, after };
constexpr Guard kGuards[] = {Guard::before, Guard::after};

// Whole pages between two PROT_NONE pages. place() puts data flush against one of them; up to 128 bytes of slack on
// either side hold a canary that intact() looks at. Reuse one buffer for many placements: mapping is slow.
class GuardedBuffer {
 public:
  // Room for `capacity` bytes plus 64 of shift.
  explicit GuardedBuffer(size_t capacity);
  ~GuardedBuffer();
  GuardedBuffer(const GuardedBuffer&) = delete;
  GuardedBuffer& operator=(const GuardedBuffer&) = delete;

  // `n` bytes whose first (Guard::before) or last (Guard::after) byte lies `shift` (0..64) bytes from the guard page:
  // shift 0 touches it, the others give every misalignment. The slack becomes canaries; the data keeps old bytes.
  uint8_t* place(size_t n, Guard guard, size_t shift = 0);

  // The same for `count` elements of T; shift in bytes, a multiple of alignof(T).
  template <class T>
  T* place_as(size_t count, Guard guard, size_t shift = 0) {
    return reinterpret_cast<T*>(place(count * sizeof(T), guard, shift));
  }

  // No canary has changed since place().
  bool intact() const;

 private:
  std::span<uint8_t> slack_before() const;
  std::span<uint8_t> slack_after() const;

  static constexpr uint8_t kCanary = 0xA5;
  static constexpr size_t kMaxSlack = 128;
  uint8_t* mapping_ = nullptr;  // with both guard pages
  size_t mapping_size_ = 0;
  std::span<uint8_t> pages_;  // between them
  size_t data_offset_ = 0, data_size_ = 0;
};

}  // namespace pac::test
