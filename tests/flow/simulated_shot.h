#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "runtime/calib/device.h"
#include "runtime/math/se3.h"
#include "tools/map/map_builder.h"

namespace roomcal::flow {

/// A device in a simulated room: its pictures, its room's map, and where its cameras truly are.
struct SimulatedShot {
  tools::LoadedMap map;
  std::unique_ptr<calib::Device> device;  ///< true intrinsics, no nominal mounting
  std::vector<cv::Mat> images;
  std::vector<SE3> T_room_cam_true;
};

/// The map of the room of this seed.
tools::LoadedMap simulated_map(uint64_t room_seed);

/// Renders; about 0.7 s of one core per megapixel.
/// @param device  stereo_rig, mobile_robot, backpack or tls.
SimulatedShot simulate_shot(const std::string& device, uint64_t room_seed, uint64_t shot_seed);

/// What the same device sees in a room like that with no marker in it, distractors kept.
std::vector<cv::Mat> simulate_bare_images(const std::string& device, uint64_t room_seed, uint64_t shot_seed);

}  // namespace roomcal::flow
