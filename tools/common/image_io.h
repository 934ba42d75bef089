#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "runtime/base/span2d.h"

namespace roomcal::tools {

/// Image file as 8-bit grey. 16-bit files are scaled to 8 bits.
/// @throws ToolError naming the path: missing, a folder, empty, or not an image.
cv::Mat read_grey(const std::filesystem::path& path);

/// The runtime's view of a grey image; the matrix must outlive it.
ImageView view(const cv::Mat& grey);

/// @throws ToolError naming the path if it cannot be written.
void write_image(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace roomcal::tools
