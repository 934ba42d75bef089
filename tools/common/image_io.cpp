#include "tools/common/image_io.h"

#include <opencv2/imgcodecs.hpp>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

cv::Mat read_grey(const fs::path& path) {
  if (!fs::exists(path)) throw ToolError(path.string() + ": no such file; check the path");
  if (!fs::is_regular_file(path)) throw ToolError(path.string() + ": is not a file; name an image");
  if (fs::file_size(path) == 0) throw ToolError(path.string() + ": is empty; was the disk full when it was written?");
  cv::Mat image;
  try {
    // Orientation tags are ignored: intrinsics belong to the sensor's own rows and columns.
    image = cv::imread(path.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw ToolError(path.string() + ": cannot be decoded (" + error.err +
                    "); is it damaged, or larger than 2^30 pixels?");
  }
  if (image.empty())
    throw ToolError(path.string() + ": is not an image that can be read (PNG, JPEG, PGM), or is damaged");
  if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 257.0);
  if (image.type() != CV_8UC1) throw ToolError(path.string() + ": has an unusual pixel format; save it as 8-bit grey");
  return image;
}

ImageView view(const cv::Mat& grey) {
  return {grey.ptr<uint8_t>(), grey.cols, grey.rows, static_cast<std::ptrdiff_t>(grey.step1())};
}

void write_image(const fs::path& path, const cv::Mat& image) {
  try {
    if (cv::imwrite(path.string(), image)) return;
  } catch (const cv::Exception&) {
    // told below: the path is what the user can mend
  }
  throw ToolError(path.string() + ": cannot be written; does the folder exist, is the disk full?");
}

}  // namespace roomcal::tools
