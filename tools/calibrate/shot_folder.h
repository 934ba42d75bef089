#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "runtime/calib/device.h"

namespace roomcal::tools {

/// The images of one shot, in the order of the device's cameras. A camera whose file is missing or damaged has an
/// empty image and a line in `troubles`: the others are still worth a look, the verdict tells.
struct Shot {
  std::vector<cv::Mat> images;
  std::vector<std::string> troubles;
};

/// Reads `<camera>.png|jpg|jpeg|pgm` of every camera.
/// @throws ToolError if the folder does not exist or holds no image of any camera of the device.
Shot read_shot(const std::filesystem::path& folder, const calib::Device& device);

}  // namespace roomcal::tools
