#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "tools/evaluate/trust_shot.h"
#include "tools/simulate/room_view.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// What every sensor of a device delivers: pictures, and sweeps decoded from packets.
struct RenderedShot {
  std::vector<cv::Mat> images;
  std::vector<Recording> recordings;
};

/// The same as take_trust_shot(), not at the level of observations but through images and a pcap in memory.
/// Cost: about 0.7 s of one core per megapixel.
RenderedShot render_trust_shot(const LitScene& lit, const TrustRoom& room, const TrustDevice& device,
                               const SE3& T_room_rig, const TrustFlaws& flaws, uint64_t seed);
/// One camera's picture only.
cv::Mat render_camera(const LitScene& lit, const TrustDevice& device, std::size_t camera, const SE3& T_room_rig,
                      uint64_t seed);

/// The runtime's view of it; the shot must outlive it.
class RenderedShotView {
 public:
  explicit RenderedShotView(const RenderedShot& shot);
  calib::Shot shot() const { return {images_, sweeps_}; }

 private:
  std::vector<ImageView> images_;
  std::vector<std::vector<lidar::Sweep>> views_;
  std::vector<calib::Sweeps> sweeps_;
};

}  // namespace roomcal::tools
