#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"
#include "tests/truth/random.h"

namespace roomcal::truth {

/// A ring marker pasted on a wall or the floor.
struct RoomMarker {
  Vec3 p_room = Vec3::Zero();        ///< circle centre, m
  Vec3 normal_room = Vec3::UnitZ();  ///< unit, into the room
};

/// The paper's room: 3 m x 4 m x 2.7 m, origin in a corner of the floor, z up.
inline const Vec3 kRoomSize_m{3.0, 4.0, 2.7};
inline constexpr std::size_t kRoomMarkers = 340;

/// Markers at random on four walls and the floor, centres at least 0.2 m apart (a sheet's width).
std::vector<RoomMarker> make_room(Random& random, std::size_t count = kRoomMarkers);

/// The lenses of the devices in the paper.
enum class LensKind : uint8_t {
  kNarrow,   ///< 1280 x 1024, pinhole radial-tangential, 40 degrees: the stereo rig
  kWide,     ///< 1280 x 720, fisheye model, 110 degrees: the robot
  kFisheye,  ///< 1920 x 1920, fisheye model, 190 degrees and more
};
camera::Camera make_camera(LensKind lens);

/// A rigid device: cameras and where they sit on it.
struct DeviceCamera {
  camera::Camera camera;
  SE3 T_rig_cam;
};

/// `count` cameras looking outward all around, turned and shifted at random by some degrees and centimetres.
std::vector<DeviceCamera> make_device(Random& random, std::size_t count, LensKind lens);

/// A place to stand: about the middle of the room, 0.8 to 1.4 m high, any heading, a few degrees of tilt.
SE3 random_T_room_rig(Random& random);

/// A marker in an image, without noise.
struct Sighting {
  uint16_t marker = 0;
  Vec2 centre_px = Vec2::Zero();
};

/// Markers whose centre lies in the image, 10 px off its border at the least, and that face the camera (slant below
/// 75 degrees). Occlusion is not modelled: the room is convex.
std::vector<Sighting> see_markers(const std::vector<RoomMarker>& room, const camera::Camera& camera,
                                  const SE3& T_room_cam);

/// A 2x2 covariance as a detector gives it: sigmas between the two bounds, any direction.
Mat22 random_cov_px2(Random& random, double min_sigma_px, double max_sigma_px);

/// A draw from N(0, cov), cov positive definite.
Vec2 draw(Random& random, const Mat22& cov);
Vec3 draw(Random& random, const Mat33& cov);

}  // namespace roomcal::truth
