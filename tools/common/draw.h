#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "runtime/marker/detector.h"

namespace roomcal::tools {

/// The grey image in colour, faded a little so that drawing stands out.
cv::Mat canvas(const cv::Mat& grey);

/// Outer ellipse and centre of every detection: green = ok, orange = seen but not used.
void draw_detections(cv::Mat& picture, std::span<const marker::Detection> detections);

}  // namespace roomcal::tools
