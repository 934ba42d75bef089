#include "tools/calibrate/shot_folder.h"

#include <array>
#include <optional>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/image_io.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

constexpr std::array kExtensions = {".png", ".jpg", ".jpeg", ".pgm"};

std::optional<fs::path> find_image(const fs::path& folder, const std::string& camera) {
  for (const char* extension : kExtensions)
    if (const fs::path file = folder / (camera + extension); fs::exists(file)) return file;
  return std::nullopt;
}

}  // namespace

Shot read_shot(const fs::path& folder, const calib::Device& device) {
  if (!fs::is_directory(folder))
    throw ToolError(folder.string() + ": no such folder; name the folder with the shot's images");
  Shot shot;
  std::size_t found = 0;
  for (const calib::CameraSpec& camera : device.cameras) {
    const std::string name(camera.name.view());
    cv::Mat image;
    if (const auto file = find_image(folder, name)) {
      ++found;
      try {
        image = read_grey(*file);
      } catch (const ToolError& error) {
        shot.troubles.push_back(name + ": " + error.what());
      }
    } else {
      shot.troubles.push_back(fmt::format("{}: {}/{}.png (or jpg, pgm) is missing", name, folder.string(), name));
    }
    shot.images.push_back(image);
  }
  if (found == 0)
    throw ToolError(
        fmt::format("{}: holds no image of this device's cameras; files are named after them, for example {}.png",
                    folder.string(), device.cameras[0].name.view()));
  return shot;
}

}  // namespace roomcal::tools
