#pragma once

#include <array>
#include <cmath>

#include "runtime/camera/camera.h"

namespace roomcal::camera::test {

/// A lens of the grid that every model test runs over.
struct Lens {
  const char* name;
  Intrinsics intrinsics;
};

inline constexpr Model kPinhole = Model::kPinholeRadtan;
inline constexpr Model kFisheye = Model::kKannalaBrandt;

/// From a plain pinhole to 220 degrees; the distortions are of the size that real calibrations have, and stronger.
inline const std::array<Lens, 10> kLenses = {{
    {"pinhole", {kPinhole, 1280, 1024, 1740, 1741, 641.8, 501.3, {0, 0, 0, 0}}},
    {"stereo", {kPinhole, 1280, 1024, 1741.8, 1741.9, 627.1, 505.7, {-0.1237, 0.1183, 3.85e-4, -3.43e-4}}},
    {"scanner", {kPinhole, 4608, 3456, 3374.2, 3375.7, 2315.1, 1747.0, {-0.0798, 0.0602, 3.0e-4, -1.9e-4}}},
    {"barrel", {kPinhole, 1280, 720, 610, 612, 632, 362, {-0.31, 0.09, 2e-3, -1.5e-3}}},
    {"pincushion", {kPinhole, 1280, 720, 610, 612, 632, 362, {0.25, 0.05, -2e-3, 3e-3}}},
    {"decentred", {kPinhole, 1280, 720, 610, 612, 632, 362, {-0.2, 0.03, 0.02, -0.03}}},
    {"wide", {kFisheye, 1280, 720, 612.2, 612.4, 634.9, 362.0, {-0.0190, 0.00449, -0.00175, 0.000338}}},
    {"190 deg", {kFisheye, 2304, 3840, 1422.6, 1422.3, 1166.4, 1888.2, {-0.0121, 0.00357, -0.00149, 0.000189}}},
    {"220 deg", {kFisheye, 1920, 1920, 480, 481, 957, 962, {-0.01, 0.003, -0.0015, 0.0002}}},
    {"folding", {kFisheye, 1280, 1280, 420, 421, 640, 641, {-0.08, 0.01, -0.004, 0.0}}},
}};

/// Radii of the field, as fractions of its widest angle, with its very edge.
inline constexpr std::array<double, 10> kFieldFractions = {0, 1e-9, 1e-4, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1 - 1e-13};

/// Unit vector at an angle from the axis, in a direction about it.
inline Vec3 bearing_at(double angle_rad, double azimuth_rad) {
  return {std::sin(angle_rad) * std::cos(azimuth_rad), std::sin(angle_rad) * std::sin(azimuth_rad),
          std::cos(angle_rad)};
}

inline Camera make_camera(const Lens& lens) {
  Result<Camera> camera = Camera::create(lens.intrinsics);
  return camera.ok() ? camera.value() : Camera{};
}

}  // namespace roomcal::camera::test
