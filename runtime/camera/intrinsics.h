#pragma once

#include <array>
#include <cstdint>

namespace roomcal::camera {

enum class Model : uint8_t {
  kPinholeRadtan,  ///< pinhole, radial-tangential k1 k2 p1 p2 (Kalibr "radtan", OpenCV order)
  kKannalaBrandt,  ///< fisheye, r(theta) = theta + k1 theta^3 + ... + k4 theta^9 (Kalibr "equidistant")
};

inline constexpr int kDistortionCount = 4;
/// Number of intrinsic parameters, in the order fx fy cx cy d0 d1 d2 d3.
inline constexpr int kIntrinsicsCount = 4 + kDistortionCount;

/// Parameters of one camera. Pixels, origin at the centre of the top-left pixel.
struct Intrinsics {
  Model model = Model::kPinholeRadtan;
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  std::array<double, kDistortionCount> distortion{};
};

}  // namespace roomcal::camera
