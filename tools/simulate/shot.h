#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "tools/simulate/marker_truth.h"
#include "tools/simulate/room_view.h"
#include "tools/simulate/sensor.h"
#include "tools/simulate/stand.h"

namespace roomcal::tools {

/// Share of the paper in a picture that is exposed below saturation.
inline constexpr double kBrightPaper = 0.9;

/// What one camera of a shot sees, before its noise.
struct Exposed {
  RadianceImage grey;  ///< noise-free grey levels
  ImageSensor sensor;
  std::vector<MarkerTruth> markers;  ///< what the picture should say
};

/// One picture and what it should say.
struct Picture {
  cv::Mat image;  ///< 8 bit, grey
  ImageSensor sensor;
  std::vector<MarkerTruth> markers;
};

/// What a camera makes of any view. @param paper_radiance  of white paper in it. `markers` stays empty.
Exposed expose_view(const Radiance& view, double paper_radiance, const TrueCamera& camera, const ShotOptions& options);

/// Cost: about 0.7 s of one core per megapixel.
Exposed expose_camera(const LitScene& lit, const TrueCamera& camera, const ShotOptions& options);

/// The noise of one picture on what the camera sees. @param seed  other seed, other noise
Picture develop(const Exposed& exposed, uint64_t seed);

/// Both.
Picture take_picture(const LitScene& lit, const TrueCamera& camera, const ShotOptions& options, uint64_t seed);

}  // namespace roomcal::tools
