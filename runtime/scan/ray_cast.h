#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/math/se3.h"
#include "runtime/scan/ray_block.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

/// Number of the face that a ray meets nowhere: tables by face have a last row for it.
inline constexpr int32_t kNoFace = kMaxFaces;
inline constexpr std::size_t kFaceRows = kMaxFaces + 1;
using FaceFloats = std::array<float, kFaceRows>;

/// What a block's rays meet.
struct BlockHits {
  alignas(64) BlockFloats inverse_m;  ///< 1 / range; 0 where nothing is on the way
  alignas(64) std::array<int32_t, kBlockRays> face;
};

/// The surface seen from one pose: all that a ray asks of it are linear forms of its direction d.
///
/// A plane n . p + h = 0 in the sensor's frame is met at 1 / range = g . d with g = -n / h; the largest positive of
/// these is the nearest plane. The point range * d is inside an edge of the outline, e . p + c >= 0, where
/// (e + c g) . d >= 0: no division, no branch, and over a box of directions such a form has bounds, by which whole
/// blocks are told from faces and edges that they do not reach.
class PosedSurface {
 public:
  PosedSurface() = default;
  PosedSurface(const Surface& surface, const SE3& T_room_lidar) { set(surface, T_room_lidar); }
  /// Cost: half a microsecond for ten faces.
  void set(const Surface& surface, const SE3& T_room_lidar);

  /// First face along each ray. A face met from behind (height_m() < 0) is one: no sensor in the room sees such a one,
  /// so the pose is wrong.
  /// Cost: 3 to 8 ns a ray in a room of ten faces.
  void cast(const RayBlock& block, BlockHits& hits) const;

  /// The next plane behind the first face, whatever its outline: what the ray could meet if that face were not there.
  /// Next to an edge of the room that is the other wall, continued. Planes seen from behind are left out.
  void cast_behind(const RayBlock& block, const BlockHits& first, BlockHits& behind) const;

  /// g of a face; zeros in row kNoFace.
  const FaceFloats& gx() const { return gx_; }
  const FaceFloats& gy() const { return gy_; }
  const FaceFloats& gz() const { return gz_; }
  /// Distance of the sensor from the face's plane; positive in front of it, 0 in row kNoFace.
  const FaceFloats& height_m() const { return height_m_; }
  std::size_t face_count() const { return count_; }

 private:
  std::size_t count_ = 0;
  FaceFloats gx_, gy_, gz_, height_m_;
  std::array<uint16_t, kFaceRows> first_edge_;
  std::array<float, kMaxEdges> ex_, ey_, ez_;
};

}  // namespace roomcal::scan
