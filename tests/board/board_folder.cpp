#include "tests/board/board_folder.h"

#include <unistd.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/evaluate/scene_map.h"
#include "tools/export/record_file.h"
#include "tools/map/map_builder.h"
#include "tools/provision/factory_record.h"
#include "tools/provision/profile_file.h"
#include "tools/provision/to_profile.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/record_lidar.h"
#include "tools/simulate/shot_files.h"

namespace roomcal::board::test {

namespace fs = std::filesystem;

namespace {

constexpr int kSweeps = 4;

tools::Scene room_of(int markers) {
  tools::RoomOptions options;
  options.markers = markers;
  return tools::make_room(options);
}

/// The small device must outlive its stand.
const tools::PaperDevice& small_device(const std::string& name, double scale) {
  static tools::PaperDevice device;
  device = tools::scaled(tools::device_named(name), scale);
  return device;
}

profile::Profile profile_of(const tools::Stand& stand) {
  profile::Profile profile;
  profile.device = "bench";
  profile.serial = "RB-0042";
  for (const tools::TrueCamera& camera : stand.cameras) {
    profile::CameraProfile sensor;
    sensor.name = std::string_view(camera.name);
    sensor.intrinsics = camera.camera.intrinsics();
    static_cast<void>(profile.cameras.push_back(sensor));
  }
  for (const tools::TrueLidar& lidar : stand.lidars) {
    profile::LidarProfile sensor;
    sensor.name = std::string_view(lidar.name);
    sensor.model = std::string_view(lidar.kind);
    const lidar::Model model = lidar.kind == "tls" ? lidar::Model::kR2000 : lidar::find_model(lidar.kind)->model;
    sensor.calibration = lidar::built_in_calibration(model).value();
    sensor.wiring.port = info(model).data_port;
    static_cast<void>(profile.lidars.push_back(sensor));
  }
  profile.wiring.replay_folder = "shots";
  profile.wiring.store.path = "store";
  return profile;
}

}  // namespace

BoardFolder::BoardFolder(const std::string& device, double scale, int markers)
    : path_(fs::temp_directory_path() / ("roomcal_board_" + std::to_string(::getpid()))),
      scene_(room_of(markers)),
      stand_(tools::place_device(scene_, small_device(device, scale), options_)),
      profile_(profile_of(stand_)) {
  fs::remove_all(path_);
  fs::create_directories(path_ / "shots");
  tools::write_atomic(path_ / "room.room", tools::build_map(tools::map_data_of(scene_)).span());
  write_grey_pictures();
  write_recordings();
}

BoardFolder::~BoardFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void BoardFolder::provision() const {
  tools::write_atomic(path_ / "device.profile", tools::build_profile(profile_).span());
  tools::write_record(path_ / "factory.record", tools::factory_record(profile_));
}

void BoardFolder::write_grey_pictures() const {
  for (const tools::TrueCamera& camera : stand_.cameras) {
    const camera::Intrinsics& k = camera.camera.intrinsics();
    tools::Picture picture;
    picture.image = cv::Mat(k.height_px, k.width_px, CV_8UC1, cv::Scalar(128));
    tools::write_picture(picture, camera.name, {tools::ImageFile::kPgm, 0}, path_ / "shots");
  }
}

void BoardFolder::render_pictures() const {
  const tools::LitScene lit(scene_);
  uint64_t seed = 0;
  for (const tools::TrueCamera& camera : stand_.cameras)
    tools::write_picture(tools::take_picture(lit, camera, options_, ++seed), camera.name, {tools::ImageFile::kPgm, 0},
                         path_ / "shots");
}

void BoardFolder::write_recordings() const {
  tools::LidarOptions options;
  options.sweeps = kSweeps;
  const tools::EchoCaster caster(scene_);
  for (const tools::TrueLidar& lidar : stand_.lidars) {
    if (lidar.kind == "tls") continue;
    for (const tools::ShotFile& file : tools::record_lidar(caster, lidar, options, 1).files)
      tools::write_atomic(path_ / "shots" / file.name, file.bytes);
  }
}

}  // namespace roomcal::board::test
