#pragma once

#include <string>
#include <vector>

#include "tools/simulate/devices.h"
#include "tools/simulate/marker_truth.h"
#include "tools/simulate/room_view.h"
#include "tools/simulate/sensor.h"

namespace roomcal::tools {

struct ShotOptions {
  uint64_t seed = 1;
  double blur_px = 0.6;      ///< sigma of the lens' point spread
  double motion_px = 0;      ///< uniform motion along x during the exposure
  double noise_sigma = 2;    ///< grey levels at mid grey
  double exposure = 1;       ///< 1: all but the brightest tenth of the paper is below saturation
  double sigma_rot_deg = 1;  ///< of the true mounting about the nominal one, per axis
  double sigma_t_m = 0.008;
};

/// One camera of the device as it truly is.
struct TrueCamera {
  std::string name;
  camera::Camera camera;
  SE3 T_room_cam;
};

/// What the truth file says of how an edge was mounted: T_to_from = [exp(rotvec) R_nominal | t_nominal + dt].
struct Perturbation {
  Vec3 rotvec_rad = Vec3::Zero();
  Vec3 dt_m = Vec3::Zero();
};

/// A device standing in a room.
struct Stand {
  const PaperDevice* device = nullptr;
  std::vector<TrueCamera> cameras;
  std::vector<Perturbation> perturbations;  ///< one per edge of the device
};

/// Draws the device's true lenses, mounting and place. The same seed gives the same stand.
Stand place_device(const Scene& scene, const PaperDevice& device, const ShotOptions& options);

/// One picture and what it should say.
struct Picture {
  cv::Mat image;  ///< 8 bit, grey
  ImageSensor sensor;
  std::vector<MarkerTruth> markers;
};

/// Cost: about 1 s of one core per megapixel.
Picture take_picture(const LitScene& lit, const TrueCamera& camera, const ShotOptions& options, uint64_t seed);

}  // namespace roomcal::tools
