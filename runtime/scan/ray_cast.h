#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/math/se3.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

inline constexpr int kNoFace = -1;

/// Where a ray meets the room.
struct RayHit {
  int face = kNoFace;
  double range_m = 0;
  /// The first thing on the way is the back of a face (`face` is then kNoFace): no sensor in the room sees such a one,
  /// so the pose is wrong.
  bool from_behind = false;
};

/// The first surface on a ray's way, and the next plane behind it whatever its outline: what the ray could meet if the
/// first face were not there. Next to an edge of the room that is the other wall, continued.
struct RayHits {
  RayHit first, second;
};

/// The surface seen from one pose: planes in the sensor's frame, so that a ray is only a direction. 3 kB; made anew for
/// every pose that is tried, some nanoseconds a face.
class PosedSurface {
 public:
  void set(const Surface& surface, const SE3& T_room_lidar);

  /// First face along a unit direction.
  /// Cost: a division a face in vector lanes, and the edges of one or two faces: 30 to 40 ns for ten faces.
  RayHit first_hit(const Vec3& direction_lidar) const;
  RayHits first_two_hits(const Vec3& direction_lidar) const;

  const Vec3& normal_lidar(std::size_t face) const { return normal_lidar_[face]; }
  /// Distance of the sensor from the face's plane; positive in front of it.
  double height_m(std::size_t face) const { return height_m_[face]; }
  std::size_t face_count() const { return count_; }

 private:
  using Ranges = std::array<float, kMaxFaces>;
  void plane_ranges(const Vec3& direction_lidar, Ranges& range_m) const;
  int nearest(const Vec3& direction_lidar, Ranges& range_m) const;
  bool inside_outline(int face, const Vec3& p_lidar) const;
  double exact_range_m(int face, const Vec3& direction_lidar) const;

  std::size_t count_ = 0;
  std::size_t padded_ = 0;
  const Surface* surface_ = nullptr;
  SE3 T_room_lidar_;
  alignas(32) std::array<float, kMaxFaces> nx_{}, ny_{}, nz_{}, h_{};
  std::array<Vec3, kMaxFaces> normal_lidar_;
  std::array<double, kMaxFaces> height_m_{};
};

}  // namespace roomcal::scan
