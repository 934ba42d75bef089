#pragma once

#include <cstdint>

#include "runtime/base/span2d.h"

namespace roomcal::marker {

/// Grey level between four pixels. @param x,y  px, from 0 to below width - 1 and height - 1: not checked.
template <typename Coordinate>
float bilinear(ImageView image, Coordinate x, Coordinate y) {
  const int ix = static_cast<int>(x);
  const int iy = static_cast<int>(y);
  const float fx = static_cast<float>(x - static_cast<Coordinate>(ix));
  const float fy = static_cast<float>(y - static_cast<Coordinate>(iy));
  const uint8_t* a = image.row(iy) + ix;
  const uint8_t* b = a + image.stride();
  const float top = static_cast<float>(a[0]) + fx * static_cast<float>(a[1] - a[0]);
  const float bottom = static_cast<float>(b[0]) + fx * static_cast<float>(b[1] - b[0]);
  return top + fy * (bottom - top);
}

}  // namespace roomcal::marker
