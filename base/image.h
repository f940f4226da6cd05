// Images in memory: non-owning views and owning images of interleaved channels; planar 4:2:0 frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <utility>

#include "base/result.h"

namespace pac {

// A rectangle of pixels that somebody else owns. `kChannels` samples of type T a pixel, interleaved; row y starts at
// data + y * stride (stride in elements of T, may be negative for bottom-up storage). Origin top left, y down.
template <class T, int kChannels>
struct ImageView {
  T* data = nullptr;
  int width = 0;   // pixels
  int height = 0;  // pixels
  ptrdiff_t stride = 0;

  T* row(int y) const { return data + y * stride; }
  T* pixel(int x, int y) const { return row(y) + ptrdiff_t{x} * kChannels; }
  bool empty() const { return width <= 0 || height <= 0; }
  operator ImageView<const T, kChannels>() const { return {data, width, height, stride}; }
};

template <class T>
using PlaneView = ImageView<T, 1>;
using RgbView = ImageView<uint8_t, 3>;
using ConstRgbView = ImageView<const uint8_t, 3>;
using RgbaView = ImageView<uint8_t, 4>;
using ConstRgbaView = ImageView<const uint8_t, 4>;

// The bytes of one owned, 64-byte aligned block that ends with 64 spare readable bytes, so that kernels may load whole
// vectors across the last pixel. Zero-initialized.
class AlignedBytes {
 public:
  static constexpr size_t kAlignment = 64;

  AlignedBytes() = default;
  explicit AlignedBytes(size_t size)
      : data_(static_cast<uint8_t*>(::operator new (size + kAlignment, std::align_val_t{kAlignment}, std::nothrow))),
        size_(size) {
    PAC_ASSERT(data_ != nullptr);  // callers check Limits first
    std::memset(data_, 0, size + kAlignment);
  }
  AlignedBytes(AlignedBytes&& other) noexcept { swap(other); }
  AlignedBytes& operator=(AlignedBytes&& other) noexcept {
    AlignedBytes(std::move(other)).swap(*this);
    return *this;
  }
  AlignedBytes(const AlignedBytes&) = delete;
  AlignedBytes& operator=(const AlignedBytes&) = delete;
  ~AlignedBytes() {
    if (data_ != nullptr) ::operator delete (data_, std::align_val_t{kAlignment});
  }

  uint8_t* data() const { return data_; }
  size_t size() const { return size_; }

 private:
  void swap(AlignedBytes& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
  }
  uint8_t* data_ = nullptr;
  size_t size_ = 0;
};

// Owns its pixels: 64-byte aligned rows, zero-initialized, move-only (clone() copies). An empty image has size 0x0.
template <class T, int kChannels>
class Image {
 public:
  Image() = default;
  // width, height >= 0; the caller has checked them against Limits (see create).
  Image(int width, int height)
      : bytes_(static_cast<size_t>(row_bytes(width)) * static_cast<size_t>(height)),
        view_{reinterpret_cast<T*>(bytes_.data()), width, height, row_bytes(width) / ptrdiff_t{sizeof(T)}} {}

  // The source becomes empty.
  Image(Image&& other) noexcept : bytes_(std::move(other.bytes_)), view_(std::exchange(other.view_, {})) {}
  Image& operator=(Image&& other) noexcept {
    bytes_ = std::move(other.bytes_);
    view_ = std::exchange(other.view_, {});
    return *this;
  }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  // As the constructor, but refuses sizes that are negative or over `limits` instead of trusting the caller.
  static Result<Image> create(int64_t width, int64_t height, const Limits& limits = {}) {
    if (width < 0 || height < 0) return Failure{Error::bad_argument, 0, "negative image size"};
    constexpr int64_t kMaxSide = 1 << 24;
    if (width > kMaxSide || height > kMaxSide ||
        static_cast<uint64_t>(width) * static_cast<uint64_t>(height) > limits.max_pixels)
      return Failure{Error::limit_exceeded, 0, "image has more pixels than the limit"};
    return Image(static_cast<int>(width), static_cast<int>(height));
  }

  int width() const { return view_.width; }
  int height() const { return view_.height; }
  ptrdiff_t stride() const { return view_.stride; }
  bool empty() const { return view_.empty(); }
  T* row(int y) { return view_.row(y); }
  const T* row(int y) const { return view_.row(y); }
  T* pixel(int x, int y) { return view_.pixel(x, y); }
  const T* pixel(int x, int y) const { return view_.pixel(x, y); }
  ImageView<T, kChannels> view() { return view_; }
  ImageView<const T, kChannels> view() const { return view_; }

  Image clone() const {
    Image copy(width(), height());
    if (!empty()) std::memcpy(copy.bytes_.data(), bytes_.data(), bytes_.size());
    return copy;
  }

 private:
  static ptrdiff_t row_bytes(int width) {
    constexpr ptrdiff_t kRow = AlignedBytes::kAlignment;
    return (ptrdiff_t{width} * kChannels * ptrdiff_t{sizeof(T)} + kRow - 1) / kRow * kRow;
  }
  AlignedBytes bytes_;
  ImageView<T, kChannels> view_;
};

using GrayImage = Image<uint8_t, 1>;
using RgbImage = Image<uint8_t, 3>;
using RgbaImage = Image<uint8_t, 4>;
using DepthImage = Image<float, 1>;
using IdImage = Image<uint32_t, 1>;

// One 4:2:0 picture ("4:1:1" in the paper's words: 4 Y to 1 Cb and 1 Cr): luma width x height, chroma rounded up
// halves.
struct Frame420 {
  GrayImage y, cb, cr;

  Frame420() = default;
  Frame420(int width, int height)
      : y(width, height), cb((width + 1) / 2, (height + 1) / 2), cr((width + 1) / 2, (height + 1) / 2) {}
  int width() const { return y.width(); }
  int height() const { return y.height(); }
};

}  // namespace pac
