#include "tools/simulate/shot.h"

namespace roomcal::tools {

Exposed expose_view(const Radiance& view, double paper_radiance, const TrueCamera& camera, const ShotOptions& options) {
  const camera::Intrinsics& lens = camera.camera.intrinsics();
  const Blur blur{options.blur_px, options.motion_px, options.defocus_px};
  const RadianceImage radiance = integrate(view, lens.width_px, lens.height_px, blur);
  Exposed exposed;
  exposed.sensor.grey_per_radiance = options.exposure * 240 / paper_radiance;
  exposed.sensor.noise_sigma = options.noise_sigma;
  exposed.sensor.vignetting = options.vignetting;
  exposed.grey = expose(radiance, exposed.sensor);
  return exposed;
}

Exposed expose_camera(const LitScene& lit, const TrueCamera& camera, const ShotOptions& options) {
  const RoomView view(lit, camera.camera, camera.T_room_cam);
  Exposed exposed = expose_view(view, view.paper_radiance_quantile(kBrightPaper), camera, options);
  exposed.markers = project_markers(lit.scene(), camera.camera, camera.T_room_cam);
  return exposed;
}

Picture develop(const Exposed& exposed, uint64_t seed) {
  Picture picture{{}, exposed.sensor, exposed.markers};
  picture.sensor.seed = seed;
  picture.image = digitize(exposed.grey, picture.sensor);
  return picture;
}

Picture take_picture(const LitScene& lit, const TrueCamera& camera, const ShotOptions& options, uint64_t seed) {
  return develop(expose_camera(lit, camera, options), seed);
}

}  // namespace roomcal::tools
