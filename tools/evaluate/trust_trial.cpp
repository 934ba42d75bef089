#include "tools/evaluate/trust_trial.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "runtime/calib/to_record.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {

namespace {

constexpr double kMove_m = 0.005, kMove_deg = 0.3;

Vec3 direction(Random& random) { return Vec3(random.normal(), random.normal(), random.normal()).normalized(); }

/// What is left of a motion of a LiDAR when the directions that its report calls weak are taken out, as a share.
double seen_share(const calib::Outcome& outcome, const std::string& name, const Vec6& xi) {
  for (const calib::LidarOutcome& lidar : outcome.lidars) {
    if (lidar.name.view() != name) continue;
    Vec3 t = lidar.T_room_lidar.R * xi.head<3>(), r = lidar.T_room_lidar.R * xi.tail<3>();
    for (const scan::WeakDirection& weak : lidar.location.weak) {
      Vec3& of = weak.rotation ? r : t;
      of -= of.dot(weak.axis_room) * weak.axis_room;
    }
    return std::max(t.norm() / kMove_m, r.norm() / deg_to_rad(kMove_deg));
  }
  return 1;
}

void add_nees(const calib::Outcome& outcome, const TrustDevice& device, MoveTally& tally) {
  const auto sensors = calib::located_sensors(outcome);
  for (std::size_t a = 0; a < sensors.size(); ++a)
    for (std::size_t b = a + 1; b < sensors.size(); ++b) {
      const rig::RelativePose pair = rig::relative_pose(outcome.solution, sensors[a].number, sensors[b].number);
      const std::string name_a(sensors[a].name.view()), name_b(sensors[b].name.view());
      const SE3 truth =
          device.T_rig_sensor[device.number_of(name_a)].inverse() * device.T_rig_sensor[device.number_of(name_b)];
      const Vec6 error = se3_log(pair.T_a_b.inverse() * truth);
      tally.nees[name_a + "-" + name_b].push_back(error.dot(pair.cov.ldlt().solve(error)));
    }
}

Vec6 draw_motion(Random& random) {
  Vec6 xi = Vec6::Zero();
  if (random.uniform() < 0.5)
    xi.head<3>() = kMove_m * direction(random);
  else
    xi.tail<3>() = deg_to_rad(kMove_deg) * direction(random);
  return xi;
}

}  // namespace

void run_move_trial(const TrustRoom& room, uint64_t seed, const TrustDeviceOptions& options, MoveTally& tally) {
  Random random = random_stream(seed, 72);
  TrustDevice device = make_trust_device(room, seed, options);
  TrustSession session(device.device, room.data());
  TrustShot before = take_trust_shot(room, device, place_trust_device(room, 2 * seed + 1), {}, random);
  ++tally.shots;
  const auto installed = std::make_unique<store::Record>();
  const calib::Outcome& first = session.run(before, nullptr);
  if (!calib::may_write(first.verdict) || !calib::to_record(first, device.device, {}, *installed).ok()) {
    ++tally.refused;
    return;
  }
  const std::size_t moved = random.below(device.sensors());
  const std::string name = device.name(moved);
  const Vec6 xi = draw_motion(random);
  double seen = seen_share(first, name, xi);

  const SE3 T_room_rig = place_trust_device(room, 2 * seed + 2);
  TrustShot after = take_trust_shot(room, device, T_room_rig, {}, random);
  const calib::Outcome& second = session.run(after, installed.get());
  add_nees(second, device, tally);
  if (second.installed.moved) ++tally.false_alarms;

  const SE3 T_before = device.T_rig_sensor[moved];
  device.T_rig_sensor[moved] = T_before * se3_exp(xi);
  after = take_trust_shot(room, device, T_room_rig, {}, random);
  const calib::Outcome& third = session.run(after, installed.get());
  ++tally.moved;
  seen = std::min(seen, seen_share(third, name, xi));
  constexpr double kHalf = 0.7;  // most of the motion lies in directions that are seen
  if (seen < kHalf) {
    ++tally.unseen;
  } else if (third.installed.moved && third.installed.moved_sensor.view() == name) {
    ++tally.named;
  } else if (third.installed.moved) {
    ++tally.misnamed;
  }
}

}  // namespace roomcal::tools
