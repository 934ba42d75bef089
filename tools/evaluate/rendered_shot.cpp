#include "tools/evaluate/rendered_shot.h"

#include <string>

#include "tools/common/image_io.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/record_lidar.h"
#include "tools/simulate/shot.h"

namespace roomcal::tools {

namespace {

/// Lens and exposure as they come; the same for the same seed.
ShotOptions draw_picture_options(uint64_t seed) {
  Random random = random_stream(seed, 60);
  ShotOptions options;
  options.blur_px = random.uniform(0.5, 0.8);
  options.vignetting = random.uniform(0, 0.3);
  options.noise_sigma = random.uniform(1, 3);
  options.exposure = random.uniform(0.7, 1.05);
  return options;
}

Recording record(const TrustRoom& room, const TrustDevice& device, std::size_t number, const SE3& T_room_rig,
                 const TrustFlaws::OfLidar& flaws, uint64_t seed) {
  const calib::LidarSpec& spec = device.device.lidars[number];
  TrueLidar lidar{.name = std::string(spec.name.view()), .unit = "vlp16", .kind = "vlp16"};
  lidar.unit_seed = seed;
  lidar.T_room_lidar = T_room_rig * device.T_rig_sensor[device.device.cameras.size() + number];
  lidar.sigma_m = spec.ranges.sigma_m;
  lidar.beam_offset_m = device.beam_offset_m[number];
  LidarOptions options;
  options.sweeps = 1;
  options.dropout = flaws.dropout;
  options.blocked_from_rad = flaws.blocked_from_rad;
  options.blocked_to_rad = flaws.blocked_to_rad;
  const LidarRecording packets = record_lidar(room.simulator().caster(), lidar, options, seed);
  LoadRequest request;
  request.model = lidar.kind;
  return load_sweeps(packets.files[0].name, packets.files[0].bytes, request);
}

}  // namespace

cv::Mat render_camera(const LitScene& lit, const TrustDevice& device, std::size_t camera, const SE3& T_room_rig,
                      uint64_t seed) {
  const TrueCamera truth{device.name(camera), device.lenses[camera], T_room_rig * device.T_rig_sensor[camera]};
  return take_picture(lit, truth, draw_picture_options(seed), 100 * seed + camera).image;
}

RenderedShot render_trust_shot(const LitScene& lit, const TrustRoom& room, const TrustDevice& device,
                               const SE3& T_room_rig, const TrustFlaws& flaws, uint64_t seed) {
  RenderedShot shot;
  for (std::size_t i = 0; i < device.device.cameras.size(); ++i)
    shot.images.push_back(render_camera(lit, device, i, T_room_rig, seed));
  for (std::size_t i = 0; i < device.device.lidars.size(); ++i)
    shot.recordings.push_back(record(room, device, i, T_room_rig, flaws.of(i), 100 * seed + 50 + i));
  return shot;
}

RenderedShotView::RenderedShotView(const RenderedShot& shot) {
  for (const cv::Mat& image : shot.images) images_.push_back(view(image));
  for (const Recording& recording : shot.recordings) {
    std::vector<lidar::Sweep>& views = views_.emplace_back();
    for (const LoadedSweep& sweep : recording.sweeps) views.push_back(sweep.view());
  }
  for (const std::vector<lidar::Sweep>& views : views_) sweeps_.emplace_back(views);
}

}  // namespace roomcal::tools
