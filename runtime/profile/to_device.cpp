#include "runtime/calib/lidar_models.h"
#include "runtime/profile/profile.h"

namespace roomcal::profile {

Status to_device(const Profile& profile, calib::Device& device) {
  device = calib::Device();
  device.reference = profile.reference;
  for (const CameraProfile& camera : profile.cameras) {
    const Result<camera::Camera> model = camera::Camera::create(camera.intrinsics);
    ROOMCAL_TRY(model.status());
    calib::CameraSpec spec{camera.name, model.value(), camera.nominal, camera.sigma_px};
    spec.serial = camera.serial;
    static_cast<void>(device.cameras.push_back(spec));  // as many as the device's, same capacity
  }
  for (const LidarProfile& lidar : profile.lidars) {
    const scan::SensorModel* ranges = calib::ranges_of(lidar.model.view());
    if (ranges == nullptr) return {StatusCode::kInvalidArgument, "a LiDAR's model is not known"};
    static_cast<void>(device.lidars.push_back({lidar.name, lidar.model, *ranges, lidar.nominal, lidar.serial}));
  }
  return ok_status();
}

}  // namespace roomcal::profile
