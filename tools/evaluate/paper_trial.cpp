#include "tools/evaluate/paper_trial.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "runtime/calib/preflight.h"
#include "tools/calibrate/runtime_device.h"
#include "tools/common/error.h"
#include "tools/device/kalibr.h"
#include "tools/device/nominal.h"
#include "tools/evaluate/baseline_bound.h"
#include "tools/evaluate/paper_figures.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/record_lidar.h"
#include "tools/simulate/shot_files.h"

namespace roomcal::tools {

namespace {

constexpr double kWrongSigmas = 5, kWrong_m = 0.003, kWrong_deg = 0.1;
constexpr uint64_t kRingStream = 81;

/// Of a ring centre, per axis, that the detector leaves in the simulator's pictures (0.6 px of blur, 2 grey levels of
/// noise): 0.0045 px on rings of 40 px, by its own word and by the truth, and less on larger ones, whose edges have
/// more pixels. tools/evaluate/paper_rendered.h shows pictures beside it.
double ring_sigma_px(double major_px) { return 0.0045 * std::sqrt(40 / major_px); }

std::vector<marker::Detection> see_rings_as_rendered(const TrustRoom& room, const TrueCamera& camera, Random& random) {
  std::vector<marker::Detection> rings = see_rings(room, camera.camera, camera.T_room_cam, random, 0);
  for (marker::Detection& ring : rings) {
    const double sigma_px = ring_sigma_px(ring.ellipse.major_px) * random.uniform(0.7, 1.3);
    ring.centre_px += sigma_px * Vec2(random.normal(), random.normal());
    ring.cov_px2 = sigma_px * sigma_px * Mat22::Identity();
  }
  return rings;
}

std::vector<LoadedSweep> whole_sweep(const TrueLidar& lidar, const LidarRecording& recording) {
  LoadRequest request;
  request.model = lidar.kind;
  const ShotFile& file = recording.files.at(0);
  std::vector<LoadedSweep> sweeps = load_sweeps(file.name, file.bytes, request).sweeps;
  const auto whole =
      std::find_if(sweeps.begin(), sweeps.end(), [](const LoadedSweep& sweep) { return calib::usable(sweep.facts); });
  if (whole == sweeps.end()) throw ToolError(file.name + ": simulated without a whole sweep");
  return {std::move(*whole)};
}

/// Axes of a sensor's report that its sweep does not tell, taken out of an error of T_to_from (frame of `from`).
void take_out_weak(const calib::Outcome& outcome, const std::string& sensor, const Mat33& R_from_room, Vec6& xi) {
  for (const calib::LidarOutcome& lidar : outcome.lidars) {
    if (lidar.name.view() != sensor) continue;
    for (const scan::WeakDirection& weak : lidar.location.weak) {
      const Vec3 axis = R_from_room * weak.axis_room;
      auto of = weak.rotation ? xi.tail<3>() : xi.head<3>();
      of -= of.dot(axis) * axis;
    }
  }
}

struct Found {
  std::string name;
  std::size_t number = 0;  ///< in the solution
  SE3 T_room_true;
};

std::vector<Found> found_sensors(const calib::Outcome& outcome, const Stand& stand) {
  std::vector<Found> found;
  const auto located = calib::located_sensors(outcome);
  for (const auto& [name, T_room_sensor] : sensor_poses(stand))
    for (const calib::LocatedSensor& sensor : located)
      if (sensor.name.view() == name) found.push_back({name, sensor.number, T_room_sensor});
  return found;
}

PairError pair_error(const calib::Outcome& outcome, const Found& to, const Found& from) {
  const rig::RelativePose pair = rig::relative_pose(outcome.solution, to.number, from.number);
  const SE3 T_true = to.T_room_true.inverse() * from.T_room_true;
  const PoseDistance off = distance_between(pair.T_a_b, T_true);
  const Vec6 xi = se3_log(pair.T_a_b.inverse() * T_true);
  Vec6 seen = xi;
  const Mat33 R_from_room = from.T_room_true.R.transpose();
  for (const Found* sensor : {&to, &from}) take_out_weak(outcome, sensor->name, R_from_room, seen);
  return {.to = to.name,
          .from = from.name,
          .position_m = off.position_m,
          .rotation_rad = off.rotation_rad,
          .seen_position_m = seen.head<3>().norm(),
          .seen_rotation_rad = seen.tail<3>().norm(),
          .baseline_m = pair.T_a_b.t.norm() - T_true.t.norm(),
          .nees = xi.dot(pair.cov.ldlt().solve(xi))};
}

double reprojection_px(const calib::Outcome& outcome) {
  double squares = 0;
  std::size_t count = 0;
  for (const calib::CameraOutcome& camera : outcome.cameras) {
    squares += 2 * camera.rms_px * camera.rms_px * static_cast<double>(camera.inliers.size());  // rms_px: per axis
    count += camera.inliers.size();
  }
  return count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
}

}  // namespace

PaperStand stand_in(const TrustRoom& room, const std::string& device, uint64_t seed) {
  PaperStand out;
  out.options.seed = seed;
  out.options.lidar.sweeps = 1;
  out.stand = place_device(room.scene(), device_named(device), out.options);
  Device described = parse_kalibr("simulated", camchain_text(out.stand));
  described.name = device;
  apply_nominal("simulated", nominal_json(out.stand, out.options).dump(), described);
  out.device = to_runtime(described, device);
  return out;
}

std::vector<std::vector<LoadedSweep>> take_sweeps(const TrustRoom& room, const PaperStand& stand, uint64_t seed) {
  std::vector<std::vector<LoadedSweep>> sweeps;
  for (const TrueLidar& lidar : stand.stand.lidars)
    sweeps.push_back(whole_sweep(
        lidar, record_lidar(room.simulator().caster(), lidar, stand.options.lidar, 100 * seed + sweeps.size())));
  return sweeps;
}

PaperShot take_paper_shot(const TrustRoom& room, const PaperStand& stand, uint64_t seed) {
  Random random = random_stream(seed, kRingStream);
  PaperShot shot;
  for (const TrueCamera& camera : stand.stand.cameras)
    shot.rings.push_back(see_rings_as_rendered(room, camera, random));
  shot.sweeps = take_sweeps(room, stand, seed);
  return shot;
}

SweepsView::SweepsView(const std::vector<std::vector<LoadedSweep>>& sweeps) {
  for (const std::vector<LoadedSweep>& of_lidar : sweeps) {
    std::vector<lidar::Sweep>& views = views_.emplace_back();
    for (const LoadedSweep& sweep : of_lidar) views.push_back(sweep.view());
  }
  for (const std::vector<lidar::Sweep>& views : views_) sweeps_.emplace_back(views);
}

bool PairError::wrong() const {
  return nees > kWrongSigmas * kWrongSigmas && (position_m > kWrong_m || rotation_rad > deg_to_rad(kWrong_deg));
}

bool PaperTrial::wrong() const {
  return accepted() && std::any_of(pairs.begin(), pairs.end(), [](const PairError& pair) { return pair.wrong(); });
}

const PairError* PaperTrial::find(const std::string& to, const std::string& from) const {
  for (const PairError& pair : pairs)
    if (pair.to == to && pair.from == from) return &pair;
  return nullptr;
}

PaperTrial judge_outcome(const calib::Outcome& outcome, const PaperStand& stand) {
  PaperTrial trial;
  trial.verdict = outcome.verdict;
  trial.rms_px = reprojection_px(outcome);
  if (!trial.accepted() && !outcome.reasons.empty()) trial.reason = std::string(outcome.reasons[0].view());
  const std::vector<Found> found = found_sensors(outcome, stand.stand);
  for (std::size_t from = 0; from < found.size(); ++from)
    for (std::size_t to = from + 1; to < found.size(); ++to)
      trial.pairs.push_back(pair_error(outcome, found[to], found[from]));
  return trial;
}

PaperTrial run_paper_trial(const TrustRoom& room, const MapData& map, double map_sigma_m, const std::string& device,
                           uint64_t seed) {
  const PaperStand stand = stand_in(room, device, seed);
  PaperShot shot = take_paper_shot(room, stand, seed);
  const SweepsView sweeps(shot.sweeps);
  const std::vector<std::span<marker::Detection>> rings(shot.rings.begin(), shot.rings.end());
  TrustSession session(stand.device, map);
  require(session.calibrate(calib::DetectedShot{rings, sweeps.sweeps()}, nullptr), "simulated shot");
  PaperTrial trial = judge_outcome(session.outcome(), stand);
  if (stand.stand.cameras.size() == 2 && stand.stand.lidars.empty())
    trial.baseline_bound_m = baseline_bound_m(room.scene(), stand.stand, shot.rings, map_sigma_m);
  return trial;
}

}  // namespace roomcal::tools
