#include "runtime/calib/memory_plan.h"

#include <algorithm>

#include "runtime/calib/outcome.h"
#include "runtime/map/triangle_index.h"

namespace roomcal::calib {

namespace {

/// Room that an array takes in an arena, with the gap that its alignment may leave before it.
template <typename T>
constexpr std::size_t array_bytes(std::size_t count) {
  return count * sizeof(T) + alignof(T);
}

std::size_t step_bytes_per_camera() {
  return array_bytes<marker::Detection>(kMaxDetections) + array_bytes<pose::Observation>(kMaxDetections) +
         pose::locate_step_bytes(kMaxDetections) + array_bytes<rig::RingObservation>(kMaxDetections);
}

}  // namespace

MemoryPlan plan_memory(const Device& device, const map::RoomMap& map) {
  const std::size_t cameras = device.cameras.size(), markers = map.marker_count();
  MemoryPlan plan;
  plan.permanent_bytes = map::TriangleIndex::bytes(markers, map.triangles().size());
  plan.step_bytes =
      cameras * step_bytes_per_camera() + array_bytes<rig::Landmark>(markers) + rig::solve_step_bytes(cameras);
  plan.scratch_bytes = std::max(pose::locate_scratch_bytes(kMaxDetections),
                                rig::solve_scratch_bytes(cameras, cameras * kMaxDetections, markers));
  for (const CameraSpec& camera : device.cameras) {
    const camera::Intrinsics& k = camera.camera.intrinsics();
    plan.scratch_bytes = std::max(plan.scratch_bytes, marker::detector_scratch_bytes(k.width_px, k.height_px));
  }
  return plan;
}

}  // namespace roomcal::calib
