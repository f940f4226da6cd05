// Where an encoder's bytes go: a vector that grows, or the caller's fixed buffer (sticky overflow).
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace pac::jpeg {

class ByteSink {
 public:
  explicit ByteSink(std::vector<uint8_t>& grows) : vector_(&grows) {}
  explicit ByteSink(std::span<uint8_t> fixed) : fixed_(fixed) {}
  // Only counts: size() is what a real sink would hold.
  ByteSink() = default;

  void append(std::span<const uint8_t> bytes) {
    if (vector_ != nullptr)
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
  bool overflowed() const { return vector_ == nullptr && size_ > fixed_.size(); }

 private:
  std::vector<uint8_t>* vector_ = nullptr;
  std::span<uint8_t> fixed_;
  size_t size_ = 0;
};

}  // namespace pac::jpeg
