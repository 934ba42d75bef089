#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace roomcal {

/// Strided view of rows; owns nothing. `stride` counts elements from one row's start to the next one's.
template <typename T>
class Span2D {
 public:
  Span2D() = default;
  Span2D(T* data, int width, int height, std::ptrdiff_t stride)
      : data_(data), width_(width), height_(height), stride_(stride) {
    assert(width >= 0 && height >= 0 && stride >= width);
  }
  Span2D(T* data, int width, int height) : Span2D(data, width, height, width) {}

  /// A mutable view is also a read-only one.
  operator Span2D<const T>() const  // NOLINT: implicit by design
      requires(!std::is_const_v<T>) {
    return {data_, width_, height_, stride_};
  }

  T* row(int y) const {
    assert(y >= 0 && y < height_);
    return data_ + y * stride_;
  }
  T& operator()(int x, int y) const {
    assert(x >= 0 && x < width_);
    return row(y)[x];
  }

  int width() const { return width_; }
  int height() const { return height_; }
  std::ptrdiff_t stride() const { return stride_; }
  bool empty() const { return width_ == 0 || height_ == 0; }

 private:
  T* data_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

/// 8-bit luminance. Pixel (0, 0) is the centre of the top-left pixel.
using ImageView = Span2D<const uint8_t>;
using MutableImageView = Span2D<uint8_t>;

}  // namespace roomcal
