#include "tools/evaluate/trust_shot.h"

#include <cmath>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "runtime/calib/lidar_models.h"
#include "tools/common/error.h"
#include "tools/common/steady_clock.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/marker_truth.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {

namespace {

constexpr double kMinDiameter_px = 15, kMaxSlant_deg = 65;
constexpr double kMountSigma_t_m = 0.008, kMountSigma_rot_deg = 1;

/// VLP-16 beside the reference camera: its y along the camera's z, then leant.
SE3 lidar_mounting(double lean_deg, const Vec3& t_m) {
  Mat33 upright;
  upright << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return {upright * so3_exp(deg_to_rad(lean_deg) * Vec3(1, 0.3, 0).normalized()), t_m};
}

SE3 disturbed(const SE3& T, Random& random) {
  Vec6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = random.normal() * (i < 3 ? kMountSigma_t_m : deg_to_rad(kMountSigma_rot_deg));
  return T * se3_exp(xi);
}

Scene usual_room(uint64_t seed) {
  RoomOptions options;
  options.seed = seed;
  return make_room(options);
}

/// Sheets and their images in mirrors, where there is light.
std::vector<MarkerTruth> sheets_in_view(const Scene& scene, const camera::Camera& camera, const SE3& T_room_cam) {
  std::vector<MarkerTruth> seen = project_markers(scene, camera, T_room_cam);
  for (const MarkerTruth& image : project_mirrored_markers(scene, camera, T_room_cam)) seen.push_back(image);
  if (!scene.darkness) return seen;
  std::set<int> lit;
  constexpr double kEnough = 0.1;  // of the light: then paper and ink differ by 20 grey levels
  for (const SceneMarker& marker : markers_of(scene))
    if (scene.darkness->share_at(marker.centre_room) >= kEnough) lit.insert(marker.id);
  std::erase_if(seen, [&](const MarkerTruth& marker) { return !lit.contains(marker.id); });
  return seen;
}

}  // namespace

camera::Camera given_lens(const camera::Camera& truth, const camera::IntrinsicsSigma& sigma, Random& random) {
  camera::Parameters off = camera::parameter_sigmas(truth, sigma);
  for (Eigen::Index k = 0; k < off.size(); ++k) off[k] *= random.normal();
  const camera::Intrinsics& k = truth.intrinsics();
  return camera::Camera::create(camera::with_parameters(k, camera::parameters_of(k) + off)).value();
}

TrustRoom::TrustRoom(uint64_t seed) : TrustRoom(usual_room(seed)) {}

TrustRoom::TrustRoom(Scene scene)
    : scene_(std::make_unique<Scene>(std::move(scene))),
      simulator_(std::make_unique<SweepSimulator>(*scene_)),
      data_(map_data_of(*scene_)) {}

TrustRoom::TrustRoom(Scene scene, MapData map)
    : scene_(std::make_unique<Scene>(std::move(scene))),
      simulator_(std::make_unique<SweepSimulator>(*scene_)),
      data_(std::move(map)) {}

std::string TrustDevice::name(std::size_t sensor) const {
  const std::size_t cameras = device.cameras.size();
  return std::string(sensor < cameras ? device.cameras[sensor].name.view()
                                      : device.lidars[sensor - cameras].name.view());
}

std::size_t TrustDevice::number_of(std::string_view wanted) const {
  for (std::size_t i = 0; i < sensors(); ++i)
    if (name(i) == wanted) return i;
  throw ToolError(fmt::format("simulated device: no sensor {}", wanted));
}

TrustDevice make_trust_device(const TrustRoom& room, uint64_t seed, const TrustDeviceOptions& wanted) {
  ShotOptions options;
  options.seed = seed;
  const PaperDevice robot = scaled(device_named("mobile_robot"), wanted.scale);
  const Stand stand = place_device(room.scene(), robot, options);
  Random random = random_stream(seed, 71);
  TrustDevice out;
  out.device.refine_intrinsics = wanted.refine_intrinsics;
  Random lens_random = random_stream(seed, 70);
  for (std::size_t i = 0; i < stand.cameras.size(); ++i) {
    const TrueCamera& camera = stand.cameras[i];
    calib::CameraSpec spec;
    spec.name = std::string_view(camera.name);
    spec.intrinsics_sigma = camera::usual_sigma(camera.camera.intrinsics());
    spec.camera =
        wanted.refine_intrinsics ? given_lens(camera.camera, spec.intrinsics_sigma, lens_random) : camera.camera;
    for (const MountingEdge& edge : robot.edges)
      if (edge.to == camera.name)  // all hang on the first one
        spec.nominal = {true, edge.T_to_from().inverse(), deg_to_rad(kMountSigma_rot_deg), kMountSigma_t_m};
    static_cast<void>(out.device.cameras.push_back(spec));
    out.lenses.push_back(camera.camera);
    out.T_rig_sensor.push_back(stand.cameras[0].T_room_cam.inverse() * camera.T_room_cam);
  }
  const SE3 nominal[] = {lidar_mounting(-40, Vec3(0.05, -0.1, -0.05)), lidar_mounting(35, Vec3(-0.05, -0.3, -0.1))};
  for (std::size_t i = 0; i < std::size(nominal); ++i) {
    calib::LidarSpec spec;
    spec.name = std::string_view(fmt::format("lidar{}", i));
    spec.model = "vlp16";
    spec.ranges = *calib::ranges_of("vlp16");
    spec.nominal = {true, nominal[i], deg_to_rad(kMountSigma_rot_deg), kMountSigma_t_m};
    static_cast<void>(out.device.lidars.push_back(spec));
    out.T_rig_sensor.push_back(disturbed(nominal[i], random));
    std::vector<double>& offsets = out.beam_offset_m.emplace_back();
    for (int beam = 0; beam < 16; ++beam) offsets.push_back(spec.ranges.beam_offset_sigma_m * random.normal());
  }
  return out;
}

SE3 place_trust_device(const TrustRoom& room, uint64_t seed) {
  ShotOptions options;
  options.seed = seed;
  return place_device(room.scene(), device_named("mobile_robot"), options).cameras[0].T_room_cam;
}

std::vector<marker::Detection> see_rings(const TrustRoom& room, const camera::Camera& camera, const SE3& T_room_cam,
                                         Random& random, double typical_sigma_px) {
  std::vector<marker::Detection> rings;
  for (const MarkerTruth& seen : sheets_in_view(room.scene(), camera, T_room_cam)) {
    if (seen.visible < 0.999 || seen.outer.major_px < kMinDiameter_px || rad_to_deg(seen.slant_rad) > kMaxSlant_deg)
      continue;
    marker::Detection ring;
    const double sigma_px = typical_sigma_px * random.uniform(0.7, 1.5);
    ring.centre_px = seen.uv_px + sigma_px * Vec2(random.normal(), random.normal());
    ring.cov_px2 = sigma_px * sigma_px * Mat22::Identity();
    ring.ellipse = {seen.outer.centre_px, seen.outer.major_px, seen.outer.minor_px, seen.outer.angle_rad};
    ring.rings = 3;
    ring.status = marker::DetectionStatus::kOk;
    rings.push_back(ring);
  }
  return rings;
}

TrustShot take_trust_shot(const TrustRoom& room, const TrustDevice& device, const SE3& T_room_rig,
                          const TrustFlaws& flaws, Random& random) {
  TrustShot shot;
  const std::size_t cameras = device.device.cameras.size();
  for (std::size_t i = 0; i < cameras; ++i)
    shot.rings.push_back(see_rings(room, device.lenses[i], T_room_rig * device.T_rig_sensor[i], random));
  for (std::size_t i = 0; i < device.device.lidars.size(); ++i) {
    SweepFlaws sweep;
    sweep.sigma_m = device.device.lidars[i].ranges.sigma_m;
    sweep.beam_offset_m = device.beam_offset_m[i];
    sweep.dropout = flaws.of(i).dropout;
    sweep.blocked_from_rad = flaws.of(i).blocked_from_rad;
    sweep.blocked_to_rad = flaws.of(i).blocked_to_rad;
    shot.sweeps.push_back(
        room.simulator().sweep(vlp16_beams(), sweep, T_room_rig * device.T_rig_sensor[cameras + i], random.bits()));
  }
  return shot;
}

TrustSession::TrustSession(const calib::Device& device, const MapData& data)
    : map_(open_map(data)),
      device_(device),
      plan_(calib::plan_memory(device, map_.map)),
      block_(plan_.total_bytes()),
      arenas_(std::move(Arenas::carve(block_, plan_.permanent_bytes, plan_.scratch_bytes)).value()),
      index_(map::TriangleIndex::build(map_.map, arenas_.permanent).value()),
      session_{.device = device_,
               .map = map_.map,
               .index = index_,
               .limits = {},
               .surface = device.lidars.empty() ? nullptr : &surface_} {
  if (!device.lidars.empty()) {
    const Result<scan::Surface> surface = scan::Surface::build(map_.map, {}, arenas_.permanent, arenas_.scratch);
    require(surface.status(), "simulated room");
    surface_ = surface.value();
  }
  arenas_.permanent.seal();
}

TrustShotView::TrustShotView(TrustShot& shot) : rings_(shot.rings.begin(), shot.rings.end()) {
  for (const SimulatedSweep& sweep : shot.sweeps) views_.push_back(sweep.view());
  for (const lidar::Sweep& view : views_) sweeps_.emplace_back(&view, 1);
}

calib::Session TrustSession::session(const store::Record* installed) const {
  return {.device = device_,
          .map = map_.map,
          .index = index_,
          .limits = {},
          .surface = device_.lidars.empty() ? nullptr : &surface_,
          .installed = installed};
}

Status TrustSession::calibrate(const calib::DetectedShot& shot, const store::Record* installed,
                               calib::Observer* observer) {
  rewind();
  return calib::calibrate(session(installed), shot, SteadyClock(), arenas_, *outcome_, observer);
}

Status TrustSession::calibrate(const calib::Shot& shot) {
  rewind();
  return calib::calibrate(session(nullptr), shot, SteadyClock(), arenas_, *outcome_);
}

const calib::Outcome& TrustSession::run(TrustShot& shot, const store::Record* installed) {
  const TrustShotView view(shot);
  require(calibrate(view.shot(), installed), "simulated shot");
  return *outcome_;
}

}  // namespace roomcal::tools
