#include "tests/flow/simulated_shot.h"

#include <utility>

#include "tools/evaluate/scene_map.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/shot.h"

namespace roomcal::flow {

namespace {

tools::Scene make_scene(uint64_t room_seed, int markers = tools::RoomOptions().markers) {
  tools::RoomOptions options;
  options.seed = room_seed;
  options.markers = markers;
  return tools::make_room(options);
}

std::vector<cv::Mat> take_pictures(const tools::Scene& scene, const tools::Stand& stand,
                                   const tools::ShotOptions& options) {
  const tools::LitScene lit(scene);
  std::vector<cv::Mat> images;
  for (const tools::TrueCamera& camera : stand.cameras)
    images.push_back(tools::take_picture(lit, camera, options, 100 * options.seed + images.size()).image);
  return images;
}

tools::LoadedMap map_of(const tools::Scene& scene) { return tools::open_map(tools::map_data_of(scene)); }

}  // namespace

tools::LoadedMap simulated_map(uint64_t room_seed) { return map_of(make_scene(room_seed)); }

SimulatedShot simulate_shot(const std::string& device, uint64_t room_seed, uint64_t shot_seed) {
  const tools::Scene scene = make_scene(room_seed);
  tools::ShotOptions options;
  options.seed = shot_seed;
  const tools::Stand stand = tools::place_device(scene, tools::device_named(device), options);
  SimulatedShot shot{map_of(scene), std::make_unique<calib::Device>(), take_pictures(scene, stand, options), {}};
  for (const tools::TrueCamera& camera : stand.cameras) {
    static_cast<void>(shot.device->cameras.push_back({std::string_view(camera.name), camera.camera, {}}));
    shot.T_room_cam_true.push_back(camera.T_room_cam);
  }
  return shot;
}

std::vector<cv::Mat> simulate_bare_images(const std::string& device, uint64_t room_seed, uint64_t shot_seed) {
  const tools::Scene scene = make_scene(room_seed, 0);
  tools::ShotOptions options;
  options.seed = shot_seed;
  return take_pictures(scene, tools::place_device(scene, tools::device_named(device), options), options);
}

}  // namespace roomcal::flow
