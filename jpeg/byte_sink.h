// Where an encoder's bytes go: a vector that grows, the caller's fixed buffer (sticky overflow), or a receiver.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

namespace pac::jpeg {

class ByteSink {
 public:
  explicit ByteSink(std::vector<uint8_t>& grows) : vector_(&grows) {}
  explicit ByteSink(std::span<uint8_t> fixed) : fixed_(fixed) {}
  // Pieces of some kilobytes; flush() sends the last one. A receiver that returns false gets no more: as overflow.
  explicit ByteSink(const std::function<bool(std::span<const uint8_t>)>& receiver) : receiver_(&receiver) {}
  // Only counts: size() is what a real sink would hold.
  ByteSink() = default;

  void append(std::span<const uint8_t> bytes) {
    if (receiver_ != nullptr)
      collect(bytes);
    else if (vector_ != nullptr)
      vector_->insert(vector_->end(), bytes.begin(), bytes.end());
    else if (size_ + bytes.size() <= fixed_.size() && !bytes.empty())
      std::memcpy(fixed_.data() + size_, bytes.data(), bytes.size());
    size_ += bytes.size();
  }
  void put(int byte) {
    const auto value = static_cast<uint8_t>(byte);
    append({&value, 1});
  }
  void put16(int value) {
    put(value >> 8);
    put(value & 255);
  }

  size_t size() const { return size_; }
  // Bytes did not fit the fixed buffer (size() still counts them).
  bool overflowed() const { return receiver_ != nullptr ? is_refused_ : vector_ == nullptr && size_ > fixed_.size(); }
  void flush() {
    if (receiver_ == nullptr || collected_.empty()) return;
    if (!is_refused_) is_refused_ = !(*receiver_)(collected_);
    collected_.clear();
  }

 private:
  static constexpr size_t kPiece = 16 * 1024;
  void collect(std::span<const uint8_t> bytes) {
    collected_.insert(collected_.end(), bytes.begin(), bytes.end());
    if (collected_.size() >= kPiece) flush();
  }

  const std::function<bool(std::span<const uint8_t>)>* receiver_ = nullptr;
  std::vector<uint8_t> collected_;
  bool is_refused_ = false;
  std::vector<uint8_t>* vector_ = nullptr;
  std::span<uint8_t> fixed_;
  size_t size_ = 0;
};

}  // namespace pac::jpeg
