#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/camera/camera.h"
#include "runtime/marker/detector.h"
#include "runtime/math/se3.h"

namespace roomcal::tools {

enum Side : std::size_t { kLeft = 0, kRight = 1 };
inline constexpr std::array<Side, 2> kBothSides{kLeft, kRight};

/// A ring centre measured in one image.
struct Sighting {
  Vec2 centre_px = Vec2::Zero();
  Mat22 cov_px2 = Mat22::Identity();
  std::optional<marker::Ellipse> ellipse;  ///< absent where only key points were surveyed
};

/// What the stereo pair saw at one stop of the survey. Left and right are in no common order.
struct StereoView {
  std::string name;
  std::array<std::vector<Sighting>, 2> seen;
};

/// A walk through the room, in the order of its file names.
struct Survey {
  std::string source;
  std::vector<StereoView> views;
  std::vector<std::string> remarks;  ///< what was lost on the way in: images without a partner, unreadable ones
};

/// The survey's calibrated pair.
struct StereoRig {
  std::array<camera::Camera, 2> cameras;
  SE3 T_right_left;

  double baseline_m() const { return T_right_left.t.norm(); }
  /// A point of the left camera's frame in the frame of `side`.
  Vec3 in_camera(Side side, const Vec3& p_left) const { return side == kLeft ? p_left : T_right_left * p_left; }
  Status project(Side side, const Vec3& p_left, Vec2& px) const {
    return cameras[side].project(in_camera(side, p_left), px);
  }
  /// Inside the image, by this much from its border.
  bool in_image(Side side, const Vec2& px, double margin_px) const;
};

/// Scales all covariances so that their median is the unit matrix's: the sizes that detectors promise are checked
/// against the residuals, only their ratios are believed, and these only within a factor of three in sigma: an image
/// that is perfect on its own still suffers from the lens model.
void normalize_covariances(Survey& survey);

/// The first two cameras of a Kalibr camchain or a device.yaml; the first is the left one.
/// @throws ToolError naming what the file lacks.
StereoRig read_stereo_rig(const std::filesystem::path& path);

}  // namespace roomcal::tools
