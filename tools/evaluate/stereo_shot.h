#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/camera/camera.h"
#include "runtime/map/triangle_index.h"
#include "runtime/pose/locate_camera.h"
#include "tools/evaluate/anchor_room.h"

namespace roomcal::tools {

/// Both cameras of one key-frame, located.
struct StereoShot {
  const camera::Camera& left;
  const camera::Camera& right;
  std::span<const Vec2> left_px;
  std::span<const Vec2> right_px;
  const pose::CameraLocation& left_location;
  const pose::CameraLocation& right_location;
  double sigma_px = 0.4;
};

/// Scratch bytes of solve_stereo_shot() for so many key points a camera and markers in the map.
std::size_t stereo_shot_bytes(std::size_t key_points, std::size_t markers);

/// The device's own joint solution (runtime/rig) of this one shot: markers that both cameras see are shared, so the
/// map's errors cancel in the baseline as far as they can.
/// @param[out] result  baseline_mm, sum2_px2, residuals.
/// @return false if the solver refused.
bool solve_stereo_shot(const StereoShot& shot, const map::TriangleIndex& index, Arena& step, Arena& scratch,
                       FrameResult& result);

}  // namespace roomcal::tools
