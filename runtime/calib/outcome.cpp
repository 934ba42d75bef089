#include "runtime/calib/outcome.h"

namespace roomcal::calib {

const char* to_string(Stage stage) {
  switch (stage) {
    case Stage::kDetect:
      return "detect";
    case Stage::kLocate:
      return "locate";
    case Stage::kLocateLidars:
      return "locate_lidars";
    case Stage::kRefine:
      return "refine";
    case Stage::kJudge:
      return "judge";
    case Stage::kCount:
      break;
  }
  return "unknown";
}

FixedVector<LocatedSensor, kMaxSensors> located_sensors(const Outcome& outcome) {
  FixedVector<LocatedSensor, kMaxSensors> sensors;  // as many places as both lists together
  for (const CameraOutcome& camera : outcome.cameras)
    if (camera.located)
      static_cast<void>(
          sensors.push_back({camera.name, camera.view, camera.in_rig, camera.T_rig_cam, camera.cov_rig_cam}));
  for (const LidarOutcome& lidar : outcome.lidars)
    if (lidar.located)
      static_cast<void>(
          sensors.push_back({lidar.name, lidar.sensor, lidar.in_rig, lidar.T_rig_lidar, lidar.cov_rig_lidar}));
  return sensors;
}

}  // namespace roomcal::calib
