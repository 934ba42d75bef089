#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "runtime/camera/camera.h"

namespace roomcal::tools {

/// What all pictures of one page may take, bytes of JPEG; the page carries a third more.
inline constexpr std::size_t kPictureBytes = 4'500'000;

/// One image as the page shows it: {uri, width_px, height_px} with the size of the original; the JPEG in `uri` is
/// smaller where it must be.
/// @param budget  bytes that the JPEG may take.
nlohmann::ordered_json picture_json(const cv::Mat& grey, std::size_t budget);

/// Unit vectors of the camera frame around its image, 32 of them, corners at every eighth: what a frustum is drawn of.
nlohmann::ordered_json outline_json(const camera::Camera& camera);

/// RFC 4648, with padding.
std::string base64(const unsigned char* bytes, std::size_t count);

}  // namespace roomcal::tools
