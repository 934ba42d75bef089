#include "tools/calibrate/shot_folder.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/core.h>

#include "runtime/calib/preflight.h"
#include "tools/common/error.h"
#include "tools/common/image_io.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

constexpr std::array kImages = {".png", ".jpg", ".jpeg", ".pgm"};
constexpr std::array kClouds = {".pcap", ".pcd", ".ply"};
constexpr std::array kAngles = {".csv", ".json", ".yaml"};

template <typename Extensions>
std::optional<fs::path> find_file(const fs::path& folder, const std::string& sensor, const Extensions& extensions) {
  for (const char* extension : extensions)
    if (const fs::path file = folder / (sensor + extension); fs::exists(file)) return file;
  return std::nullopt;
}

cv::Mat read_camera(const fs::path& folder, const std::string& name, ShotFolder& shot, std::size_t& found) {
  const auto file = find_file(folder, name, kImages);
  if (!file) {
    shot.troubles.push_back(fmt::format("{}: {}/{}.png (or jpg, pgm) is missing", name, folder.string(), name));
    return {};
  }
  ++found;
  try {
    return read_grey(*file);
  } catch (const ToolError& error) {
    shot.troubles.push_back(name + ": " + error.what());
    return {};
  }
}

/// Whole sweeps first: the session leaves out the others, and says so.
void keep_first(std::vector<LoadedSweep>& sweeps, std::size_t count) {
  const auto whole = [](const LoadedSweep& sweep) { return calib::usable(sweep.facts); };
  if (std::none_of(sweeps.begin(), sweeps.end(), whole)) return;
  std::stable_partition(sweeps.begin(), sweeps.end(), whole);
  if (count != kAllSweeps && sweeps.size() > count) sweeps.resize(count);
}

std::vector<LoadedSweep> read_lidar(const fs::path& folder, const Sensor& sensor, std::size_t count, ShotFolder& shot) {
  std::optional<fs::path> file = find_file(folder, sensor.name, kClouds);
  if (!sensor.file.empty() && fs::exists(folder / sensor.file)) file = folder / sensor.file;
  if (!file) {
    shot.troubles.push_back(
        fmt::format("{}: {}/{}.pcap (or pcd, ply) is missing", sensor.name, folder.string(), sensor.name));
    shot.sweep_files.emplace_back();
    return {};
  }
  shot.sweep_files.push_back(file->lexically_relative(folder).string());
  LoadRequest request;
  request.file = *file;
  request.model = sensor.lidar_model;
  request.calibration = find_file(folder, sensor.name, kAngles).value_or(fs::path());
  // Some turns more than asked for: the first and those with losses do not count.
  if (count != kAllSweeps) request.max_sweeps = count + 4;
  try {
    Recording recording = load_sweeps(request);
    for (const std::string& warning : recording.report.warnings) shot.troubles.push_back(sensor.name + ": " + warning);
    // A recording ends where it was stopped: its last, unfinished turn is nobody's fault.
    while (recording.sweeps.size() > 1 && (recording.sweeps.back().facts.flags & lidar::kSweepPartial) != 0)
      recording.sweeps.pop_back();
    keep_first(recording.sweeps, count);
    return std::move(recording.sweeps);
  } catch (const ToolError& error) {
    shot.troubles.push_back(sensor.name + ": " + error.what());
    return {};
  }
}

}  // namespace

ShotFolder read_shot(const fs::path& folder, const Device& device, std::size_t sweeps) {
  if (!fs::is_directory(folder))
    throw ToolError(folder.string() + ": no such folder; name the folder with the shot's images");
  ShotFolder shot;
  std::size_t found = 0;
  for (const Sensor& sensor : device.sensors) {
    if (sensor.kind == SensorKind::kCamera)
      shot.images.push_back(read_camera(folder, sensor.name, shot, found));
    else
      shot.sweeps.push_back(read_lidar(folder, sensor, sweeps, shot));
  }
  if (found == 0)
    throw ToolError(
        fmt::format("{}: holds no image of this device's cameras; files are named after them, for example {}.png",
                    folder.string(), device.rig_frame));
  return shot;
}

ShotView::ShotView(const ShotFolder& folder) {
  for (const cv::Mat& image : folder.images) images_.push_back(view(image));
  for (const std::vector<LoadedSweep>& sweeps : folder.sweeps) {
    std::vector<lidar::Sweep>& views = views_.emplace_back();
    for (const LoadedSweep& sweep : sweeps) views.push_back(sweep.view());
  }
  for (const std::vector<lidar::Sweep>& views : views_) sweeps_.emplace_back(views);
}

}  // namespace roomcal::tools
