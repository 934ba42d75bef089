#include "tools/evaluate/lidar_trial.h"

#include <array>
#include <cmath>
#include <ctime>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "runtime/map/sample_surface.h"
#include "tools/common/error.h"
#include "tools/map/map_builder.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/ray.h"

namespace roomcal::tools {

namespace {

constexpr double kClearance_m = 0.5;

Vec3 random_direction(Random& random) {
  const Vec3 v(random.normal(), random.normal(), random.normal());
  return v.normalized();
}

double clearance_in(const Scene& scene, const Vec3& p_room) {
  double least_m = 1e9;
  for (const Plane& wall : scene.walls) least_m = std::min(least_m, wall.signed_distance(p_room));
  for (const Body& body : scene.bodies) least_m = std::min(least_m, clearance(body, p_room));
  return least_m;
}

double tilt_rad(Tilt tilt, Random& random) {
  switch (tilt) {
    case Tilt::kUpright:
      return deg_to_rad(random.uniform(0, 3));
    case Tilt::kTilted:
      return deg_to_rad(random.uniform(5, 30));
    case Tilt::kSteep:
      return deg_to_rad(75);
  }
  return 0;
}

/// Sums of J J' and of J per beam for the rays of one column.
struct BoundSums {
  Mat66 A = Mat66::Zero();
  std::vector<Vec6> v;
  std::vector<double> n;
};

/// A pose moved a step to both sides along each tangent direction.
constexpr double kStep = 1e-5;
using Moved = std::array<std::pair<SE3, SE3>, 6>;
Moved moved_poses(const SE3& T) {
  Moved moved;
  for (int i = 0; i < 6; ++i) {
    Vec6 xi = Vec6::Zero();
    xi[i] = kStep;
    moved[static_cast<std::size_t>(i)] = {T * se3_exp(xi), T * se3_exp(-xi)};
  }
  return moved;
}

void add_ray(const Scene& scene, const Moved& moved, const Vec3& along_lidar, std::size_t beam, BoundSums& sums) {
  constexpr double kJump_m = 1e-3;
  const auto range_m = [&](const SE3& T) { return cast_ray(scene, T.t, T.R * along_lidar).distance; };
  Vec6 J;
  for (int i = 0; i < 6; ++i) {
    const auto& [plus, minus] = moved[static_cast<std::size_t>(i)];
    const double change_m = range_m(plus) - range_m(minus);
    if (!(std::abs(change_m) < kJump_m)) return;  // across a silhouette there is no derivative
    J[i] = change_m / (2 * kStep);
  }
  sums.A += J * J.transpose();
  sums.v[beam] += J;
  sums.n[beam] += 1;
}

/// A pose that is off by the spec's error, in a random direction.
scan::PosePrior wrong_prior(const LidarTrialSpec& spec, const SE3& T_room_lidar, Random& random) {
  scan::PosePrior prior;
  const double error_rad = deg_to_rad(spec.prior_error_deg);
  Vec6 off;
  off << spec.prior_error_m * random_direction(random), error_rad * random_direction(random);
  prior.T_room_lidar = T_room_lidar * se3_exp(off);
  prior.cov.setZero();  // the error's length is its sigma, shared by three axes
  prior.cov.diagonal().head<3>().setConstant(std::pow(spec.prior_error_m, 2) / 3);
  prior.cov.diagonal().tail<3>().setConstant(error_rad * error_rad / 3);
  return prior;
}

}  // namespace

LidarRoom::LidarRoom(uint64_t seed, bool pillar, const Vec3& size_m, int markers) {
  RoomOptions options;
  options.seed = seed;
  options.pillar = pillar;
  options.size = size_m;
  options.markers = markers;
  scene_ = std::make_unique<Scene>(make_room(options));
  simulator_ = std::make_unique<SweepSimulator>(*scene_);
  const std::vector<std::vector<Vec3>> outlines = surface_polygons(*scene_);
  std::vector<scan::Polygon> polygons;
  for (const std::vector<Vec3>& outline : outlines) polygons.push_back({outline});
  std::vector<scan::Print> prints;
  uint32_t face = 0;
  const auto add_prints = [&](const Plane& plane) {
    for (const Decal& decal : plane.decals) {
      if (decal.print == Print::kRings) prints.push_back({plane.point(decal.centre), decal.radius_m, face});
    }
    ++face;
  };
  for (const Plane& wall : scene_->walls) add_prints(wall);
  for (const Body& body : scene_->bodies) {
    for (const Plane& plane : body.faces) add_prints(plane);
  }
  bytes_.resize(scan::Surface::bytes(polygons.size(), prints.size()));
  Arena arena{bytes_};
  const Result<scan::Surface> surface = scan::Surface::from_polygons(polygons, prints, arena);
  if (!surface.ok()) throw ToolError(surface.status().detail());
  surface_ = surface.value();
  densify(outlines);
}

void LidarRoom::densify(const std::vector<std::vector<Vec3>>& outlines) {
  MapData data;
  data.id = "dense";
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    const scan::Face& face = surface_.faces()[i];
    data.planes.push_back({{face.normal_room, face.d_m, 0.001}, outlines[i]});
  }
  for (const SceneMarker& marker : markers_of(*scene_)) {  // a map without markers is none
    map::MapMarker& m = data.markers.emplace_back();
    m.id = static_cast<uint32_t>(marker.id);
    m.p_room = marker.centre_room;
  }
  const AlignedBytes bytes = build_map(data);
  const map::RoomMap map = map::RoomMap::open(bytes.span()).value();
  dense_bytes_.resize(scan::GicpTarget::bytes(map::surface_point_count(map)));
  Arena arena{dense_bytes_};
  const Result<scan::GicpTarget> dense = scan::GicpTarget::build(map, 0, arena);
  if (!dense.ok()) throw ToolError(dense.status().detail());
  dense_ = dense.value();
}

const char* to_string(Tilt tilt) {
  switch (tilt) {
    case Tilt::kUpright:
      return "upright";
    case Tilt::kTilted:
      return "5-30 deg";
    case Tilt::kSteep:
      return "75 deg";
  }
  return "";
}

ObservedError observed_error(const scan::Location& location, const SE3& T_room_lidar) {
  const Mat33& R = location.T_room_lidar.R;
  const Vec6 error = se3_log(location.T_room_lidar.inverse() * T_room_lidar);
  Vec3 position_room = R * error.head<3>(), rotation_room = R * error.tail<3>();
  for (const scan::WeakDirection& weak : location.weak) {
    Vec3& of = weak.rotation ? rotation_room : position_room;
    of -= of.dot(weak.axis_room) * weak.axis_room;
  }
  return {position_room.norm(), rotation_room.norm()};
}

SE3 random_lidar_pose(const Scene& scene, Tilt tilt, Random& random) {
  SE3 T;
  do {
    for (int i = 0; i < 3; ++i) T.t[i] = random.uniform(0, scene.size[i]);
  } while (clearance_in(scene, T.t) < kClearance_m);
  const double towards_rad = random.uniform(0, 2 * kPi);
  const Vec3 axis(std::cos(towards_rad), std::sin(towards_rad), 0);
  T.R = so3_exp(tilt_rad(tilt, random) * axis) * so3_exp(random.uniform(-kPi, kPi) * Vec3::UnitZ());
  return T;
}

PoseBound pose_bound(const Scene& scene, const BeamTable& beams, const SE3& T_room_lidar, double sigma_m,
                     double beam_offset_sigma_m) {
  constexpr int kEvery = 4;
  const Moved moved = moved_poses(T_room_lidar);
  BoundSums sums;
  sums.v.assign(beams.elevation_rad.size(), Vec6::Zero());
  sums.n.assign(beams.elevation_rad.size(), 0);
  for (int column = 0; column < beams.columns; column += kEvery) {
    const double azimuth_rad = 2 * kPi * column / beams.columns;
    for (std::size_t beam = 0; beam < beams.elevation_rad.size(); ++beam) {
      const double c = std::cos(beams.elevation_rad[beam]);
      const Vec3 along(c * std::sin(azimuth_rad), c * std::cos(azimuth_rad), std::sin(beams.elevation_rad[beam]));
      add_ray(scene, moved, along, beam, sums);
    }
  }
  const double weight = kEvery / (sigma_m * sigma_m);
  Mat66 information = weight * sums.A;
  for (std::size_t beam = 0; beam < sums.v.size() && beam_offset_sigma_m > 0; ++beam) {
    const double pivot = weight * sums.n[beam] + 1 / (beam_offset_sigma_m * beam_offset_sigma_m);
    information -= weight * weight * sums.v[beam] * sums.v[beam].transpose() / pivot;
  }
  const Mat66 cov = scan::covariance_of(information);
  return {std::sqrt(cov.topLeftCorner<3, 3>().trace()), std::sqrt(cov.bottomRightCorner<3, 3>().trace())};
}

LidarTrialSetup set_up_lidar_trial(const LidarRoom& room, const LidarTrialSpec& spec) {
  LidarTrialSetup setup;
  Random random = random_stream(spec.seed, static_cast<uint64_t>(spec.tilt));
  const BeamTable beams = vlp16_beams();
  setup.T_room_lidar = random_lidar_pose(room.scene(), spec.tilt, random);
  setup.bound = pose_bound(room.scene(), beams, setup.T_room_lidar, spec.sigma_m, spec.beam_offset_sigma_m);
  SweepFlaws flaws;
  flaws.sigma_m = spec.sigma_m;
  for (std::size_t i = 0; i < beams.elevation_rad.size(); ++i) {
    flaws.beam_offset_m.push_back(spec.beam_offset_sigma_m * random.normal());
  }
  setup.sweep = room.simulator().sweep(beams, flaws, setup.T_room_lidar, random.bits());
  setup.prior = wrong_prior(spec, setup.T_room_lidar, random);
  setup.sensor.sigma_m = spec.sigma_m;
  setup.sensor.beam_offset_sigma_m = spec.beam_offset_sigma_m;
  return setup;
}

LidarTrial judge_lidar_trial(const LidarTrialSpec& spec, const LidarTrialSetup& setup, const scan::Location& location,
                             double locate_ms) {
  LidarTrial trial;
  trial.spec = spec;
  trial.bound = setup.bound;
  trial.T_room_lidar = setup.T_room_lidar;
  trial.location = location;
  trial.locate_ms = locate_ms;
  const Vec6 error = se3_log(location.T_room_lidar.inverse() * setup.T_room_lidar);
  trial.nees = error.dot(location.cov.ldlt().solve(error));
  trial.position_error_m = error.head<3>().norm();
  trial.rotation_error_rad = error.tail<3>().norm();
  trial.observed = observed_error(location, setup.T_room_lidar);
  return trial;
}

LidarTrial run_lidar_trial(const LidarRoom& room, const LidarTrialSpec& spec) {
  const LidarTrialSetup setup = set_up_lidar_trial(room, spec);
  const lidar::Sweep sweep = setup.sweep.view();
  scan::LocateOptions options;
  options.use_reflectivity = spec.use_reflectivity;
  const bool by_gicp = spec.method == LidarMethod::kGicp;
  std::vector<std::byte> bytes(by_gicp ? scan::locate_by_gicp_scratch_bytes() : scan::locate_scratch_bytes());
  Arena scratch{bytes};
  const scan::PosePrior* prior = spec.prior ? &setup.prior : nullptr;
  scan::Location location;
  const double start_ms = thread_cpu_ms();
  const Status status =
      by_gicp ? scan::locate_by_gicp(room.surface(), room.dense(), {&sweep, 1}, setup.sensor, prior, options, {},
                                     scratch, location)
              : scan::locate(room.surface(), {&sweep, 1}, setup.sensor, prior, options, scratch, location);
  const double locate_ms = thread_cpu_ms() - start_ms;
  if (!status.ok()) throw ToolError(status.detail());
  return judge_lidar_trial(spec, setup, location, locate_ms);
}

double thread_cpu_ms() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

}  // namespace roomcal::tools
