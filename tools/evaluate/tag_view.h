#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "tools/evaluate/tag_detector.h"
#include "tools/simulate/room_view.h"

namespace roomcal::tools {

/// The same room with nothing printed on its sheets.
Scene with_blank_sheets(Scene scene);

/// Corners of the tag on a sheet, in the order of kTagCorners: the tag is as wide as the ring marker it stands for.
std::array<Vec3, 4> tag_corners_room(const Plane& plane, const Decal& sheet);

/// A room seen through one camera with an AprilTag on every sheet, the sheet's marker's number in it. The walls are
/// flat and nothing stands in the room.
class TagView final : public Radiance {
 public:
  /// @param blank  lit with_blank_sheets(rings). @param rings  the room with its sheets; both must outlive the view.
  TagView(const LitScene& blank, const Scene& rings, const camera::Camera& camera, const SE3& T_room_cam);

  void sample(int x, int y, PixelSamples& samples) const override;
  const RoomView& blank() const { return blank_; }

 private:
  const Scene& rings_;
  const camera::Camera& camera_;
  SE3 T_room_cam_;
  RoomView blank_;
  std::map<int, std::shared_ptr<const TagCells>> cells_;  ///< by marker
};

}  // namespace roomcal::tools
