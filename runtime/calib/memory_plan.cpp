#include "runtime/calib/memory_plan.h"

#include <algorithm>

#include "runtime/calib/outcome.h"
#include "runtime/map/triangle_index.h"
#include "runtime/scan/locate.h"
#include "runtime/scan/outline.h"
#include "runtime/scan/plane_pull.h"
#include "runtime/scan/surface.h"

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

/// Surface::build() gathers every plane's points: its markers, or its outline.
std::size_t surface_scratch_bytes(const map::RoomMap& map) {
  std::size_t points = map.marker_count();
  for (std::size_t i = 0; i < map.plane_count(); ++i) points += map.outline_size(i);
  return array_bytes<scan::PlaneExtent>(map.plane_count()) + points * sizeof(Vec3) +
         map.plane_count() * alignof(std::max_align_t);
}

}  // namespace

MemoryPlan plan_memory(const Device& device, const map::RoomMap& map) {
  const std::size_t cameras = device.cameras.size(), lidars = device.lidars.size(), markers = map.marker_count();
  const std::size_t sensors = cameras + lidars, lenses = device.refine_intrinsics ? cameras : 0;
  MemoryPlan plan;
  plan.permanent_bytes = map::TriangleIndex::bytes(markers, map.triangles().size());
  plan.step_bytes = cameras * step_bytes_per_camera() + array_bytes<rig::Landmark>(markers) +
                    // As often as a LiDAR is located again, and once without the held-out markers.
                    3 * rig::solve_step_bytes(sensors, lenses) + array_bytes<double>(cameras * kMaxDetections / 2);
  plan.scratch_bytes = std::max(pose::locate_scratch_bytes(kMaxDetections) + array_bytes<double>(kMaxDetections),
                                rig::solve_scratch_bytes(sensors, cameras * kMaxDetections, markers, lenses, lidars));
  for (const CameraSpec& camera : device.cameras) {
    const camera::Intrinsics& k = camera.camera.intrinsics();
    plan.scratch_bytes = std::max(plan.scratch_bytes, marker::detector_scratch_bytes(k.width_px, k.height_px));
  }
  if (lidars > 0) {
    plan.permanent_bytes += scan::Surface::bytes(map.plane_count(), markers);
    plan.step_bytes += array_bytes<lidar::Sweep>(kMaxSweeps) + array_bytes<scan::Location>(1) +
                       array_bytes<Mat33>(map.plane_count()) +
                       2 * lidars * array_bytes<rig::PlanePull>(rig::kMaxPulls);  // once more where it is located again
    plan.scratch_bytes = std::max({plan.scratch_bytes, scan::locate_scratch_bytes(), scan::face_pull_scratch_bytes(),
                                   surface_scratch_bytes(map)});
  }
  return plan;
}

}  // namespace roomcal::calib
