#include "tools/report/report_page.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "runtime/calib/lidar_models.h"
#include "tools/calibrate/shot_folder.h"
#include "tools/common/error.h"
#include "tools/map/map_builder.h"
#include "tools/map/room_json.h"
#include "tools/page/page.h"
#include "tools/report/assets.h"
#include "tools/report/compare_poses.h"
#include "tools/report/report_pictures.h"
#include "tools/report/report_sweeps.h"
#include "tools/report/result_file.h"

namespace roomcal::tools {

using Json = nlohmann::ordered_json;

namespace {

/// The device as a shot folder wants it: names, kinds, models, files.
Device device_of(const ResultFile& result) {
  Device device;
  device.rig_frame = result.rig_frame;
  for (const SensorResult& in : result.sensors) {
    Sensor sensor;
    sensor.name = in.name;
    sensor.kind = in.lidar ? SensorKind::kLidar : SensorKind::kCamera;
    if (in.lidar) {
      sensor.lidar_model = in.lidar->model;
      sensor.file = in.lidar->file;
    }
    device.sensors.push_back(sensor);
  }
  return device;
}

/// As many sweeps of each LiDAR as took part, or one.
std::size_t sweeps_of(const ResultFile& result) {
  std::size_t sweeps = 1;
  for (const SensorResult& sensor : result.sensors)
    if (sensor.lidar) sweeps = std::max(sweeps, sensor.lidar->sweeps);
  return sweeps;
}

/// What a shot adds to a page.
class ShotPart {
 public:
  ShotPart(const ResultFile& result, const std::filesystem::path& folder, const map::RoomMap* map)
      : result_(result), map_(map), shot_(read_shot(folder, device_of(result), sweeps_of(result))) {
    std::size_t camera = 0, lidar = 0;
    for (const SensorResult& sensor : result.sensors) {
      if (sensor.camera) {
        cameras_.push_back({&sensor, &shot_.images[camera++]});
        continue;
      }
      const std::vector<LoadedSweep>& sweeps = shot_.sweeps[lidar++];
      if (sensor.T_room_sensor && !sweeps.empty() && calib::ranges_of(sensor.lidar->model) != nullptr)
        lidars_.push_back({&sensor, &sweeps});
    }
  }

  const std::vector<std::string>& troubles() const { return shot_.troubles; }

  Json pictures() const {
    Json pictures = Json::object();
    const std::size_t budget = kPictureBytes / std::max<std::size_t>(1, cameras_.size());
    for (const auto& [sensor, image] : cameras_)
      if (!image->empty()) pictures[sensor->name] = picture_json(*image, budget);
    return pictures;
  }
  Json sweeps() const {
    Json sweeps = Json::object();
    for (const LocatedSweeps& located : lidars_)
      sweeps[located.sensor->name] = sweep_json(located, map_, kRoomPoints / lidars_.size());
    return sweeps;
  }
  Json projections() const {
    Json all = Json::object();
    const std::size_t wanted = kImagePoints / std::max<std::size_t>(1, cameras_.size() * lidars_.size());
    for (const auto& [camera, image] : cameras_) {
      if (image->empty() || !camera->T_room_sensor) continue;
      Json points = Json::object();
      for (const LocatedSweeps& located : lidars_)
        points[located.sensor->name] = projection_json(*camera, located, wanted);
      if (!points.empty()) all[camera->name] = std::move(points);
    }
    return all;
  }

 private:
  const ResultFile& result_;
  const map::RoomMap* map_;
  ShotFolder shot_;
  std::vector<std::pair<const SensorResult*, const cv::Mat*>> cameras_;
  std::vector<LocatedSweeps> lidars_;
};

LoadedMap load_same_map(const std::filesystem::path& path, const ResultFile& result) {
  LoadedMap loaded = load_map(path);
  const std::string hash = fmt::format("{:08x}", loaded.map.content_crc32c());
  const std::string expected = result.json.value("/map/hash"_json_pointer, std::string());
  if (!expected.empty() && hash != expected)
    throw ToolError(
        fmt::format("{}: is another map than the result's (content {}, not {}); give the map that the shot "
                    "was calibrated with",
                    path.string(), hash, expected));
  return loaded;
}

Json outlines_of(const ResultFile& result) {
  Json outlines = Json::object();
  for (const SensorResult& sensor : result.sensors)
    if (sensor.camera) outlines[sensor.name] = outline_json(*sensor.camera);
  return outlines;
}

std::string title_of(const ResultFile& result) {
  const std::string device = result.json.value("device", std::string());
  return device.empty() ? "Calibration" : "Calibration of " + device;
}

}  // namespace

ReportPage report_page(const ReportInput& input) {
  const ResultFile result = read_result(input.result);
  ReportPage page;
  Json content = {{"title", title_of(result)},
                  {"source", input.result.filename().string()},
                  {"result", result.json},
                  {"outlines", outlines_of(result)}};
  std::optional<LoadedMap> loaded;
  if (!input.map.empty()) {
    loaded.emplace(load_same_map(input.map, result));
    content["room"] = room_json(to_map_data(loaded->map));
  }
  if (!input.shot.empty()) {
    const ShotPart shot(result, input.shot, loaded ? &loaded->map : nullptr);
    content["pictures"] = shot.pictures();
    content["sweeps"] = shot.sweeps();
    content["projections"] = shot.projections();
    page.notes = shot.troubles();
  }
  if (!input.installed.empty()) content["installed"] = against_installed(result, read_result(input.installed));
  if (!input.truth.empty()) content["truth"] = against_truth(result, input.truth);
  content["notes"] = page.notes;
  page.html = make_page(title_of(result), report_assets::report_css,
                        {report_assets::report_parts_js, report_assets::report_charts_js,
                         report_assets::report_covariance_js, report_assets::report_pictures_js,
                         report_assets::report_plan_js, report_assets::report_glyphs_js, report_assets::report_scene_js,
                         report_assets::report_device_js, report_assets::report_tables_js, report_assets::report_js},
                        content);
  return page;
}

}  // namespace roomcal::tools
