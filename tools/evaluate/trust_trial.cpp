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
constexpr double kWrong_m = 0.005, kWrong_deg = 0.2;
constexpr double kMarkersMoved = 0.3, kMarkerShift_m = 0.03;

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

std::size_t index_of(const TrustDevice& device, std::string_view name) {
  for (std::size_t i = 0; i < device.sensors(); ++i)
    if (device.name(i) == name) return i;
  return 0;
}

void add_nees(const calib::Outcome& outcome, const TrustDevice& device, MoveTally& tally) {
  const auto sensors = calib::located_sensors(outcome);
  for (std::size_t a = 0; a < sensors.size(); ++a)
    for (std::size_t b = a + 1; b < sensors.size(); ++b) {
      const rig::RelativePose pair = rig::relative_pose(outcome.solution, sensors[a].number, sensors[b].number);
      const std::string name_a(sensors[a].name.view()), name_b(sensors[b].name.view());
      const SE3 truth =
          device.T_rig_sensor[index_of(device, name_a)].inverse() * device.T_rig_sensor[index_of(device, name_b)];
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

/// Whether an extrinsic that would be written is off where the report calls it observed.
bool off_truth(const calib::Outcome& outcome, const TrustDevice& device) {
  for (const calib::LocatedSensor& sensor : calib::located_sensors(outcome)) {
    if (!sensor.in_rig) continue;
    Vec6 error =
        se3_log(sensor.T_rig_sensor.inverse() * device.T_rig_sensor[index_of(device, std::string(sensor.name.view()))]);
    for (const calib::LidarOutcome& lidar : outcome.lidars) {
      if (lidar.name.view() != sensor.name.view()) continue;
      for (const scan::WeakDirection& weak : lidar.location.weak) {
        const Vec3 axis = lidar.T_room_lidar.R.transpose() * weak.axis_room;
        auto of = weak.rotation ? error.tail<3>() : error.head<3>();
        of -= of.dot(axis) * axis;
      }
    }
    if (error.head<3>().norm() > kWrong_m || error.tail<3>().norm() > deg_to_rad(kWrong_deg)) return true;
  }
  return false;
}

MapData with_moved_markers(MapData data, Random& random) {
  for (map::MapMarker& marker : data.markers) {
    if (random.uniform() >= kMarkersMoved) continue;
    const Vec3 any = direction(random);
    marker.p_room += kMarkerShift_m * (any - any.dot(marker.normal_room) * marker.normal_room).normalized();
  }
  return data;
}

/// The markers of one wall, mirrored about the upright line through its middle.
MapData with_mirrored_wall(MapData data, Random& random) {
  const int wall = data.markers[random.below(data.markers.size())].plane;
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const map::MapMarker& marker : data.markers) {
    if (marker.plane != wall) continue;
    sum += marker.p_room;
    ++count;
  }
  for (map::MapMarker& marker : data.markers) {
    if (marker.plane != wall || count == 0) continue;
    const Vec3 up = std::abs(marker.normal_room.z()) > 0.5 ? Vec3::UnitY() : Vec3::UnitZ();
    const Vec3 across = up.cross(marker.normal_room).normalized();
    marker.p_room -= 2 * across.dot(marker.p_room - sum / count) * across;
  }
  return data;
}

MapData map_for(Trap trap, const TrustRoom& room, const TrustRoom& other, Random& random) {
  switch (trap) {
    case Trap::kWrongRoom:
      return other.data();
    case Trap::kMarkersMoved:
      return with_moved_markers(room.data(), random);
    case Trap::kMirroredWall:
      return with_mirrored_wall(room.data(), random);
    case Trap::kOtherRoomsCamera:
    case Trap::kBlockedLidar:
    case Trap::kUnmappedPillar:
      return room.data();
  }
  return room.data();
}

}  // namespace

const char* to_string(Trap trap) {
  switch (trap) {
    case Trap::kWrongRoom:
      return "map of another room";
    case Trap::kMarkersMoved:
      return "30 % of markers moved by 30 mm";
    case Trap::kOtherRoomsCamera:
      return "one camera in another room";
    case Trap::kMirroredWall:
      return "one wall mirrored in the map";
    case Trap::kBlockedLidar:
      return "LiDARs blocked over 270 degrees";
    case Trap::kUnmappedPillar:
      return "a pillar that the map lacks";
  }
  return "";
}

void run_move_trial(const TrustRoom& room, uint64_t seed, const TrustOptions& options, MoveTally& tally) {
  Random random = random_stream(seed, 72);
  TrustDevice device = make_trust_device(room, seed, options.refine_intrinsics);
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

void run_trap(Trap trap, const TrustRoom& room, const TrustRoom& other, uint64_t seed, TrapTally& tally) {
  Random random = random_stream(seed, 73 + static_cast<uint64_t>(trap));
  const TrustDevice device = make_trust_device(room, seed);
  TrustFlaws flaws;
  if (trap == Trap::kBlockedLidar) flaws.blocked_rad = deg_to_rad(270);
  TrustShot shot = take_trust_shot(room, device, place_trust_device(room, 2 * seed + 1), flaws, random);
  if (trap == Trap::kOtherRoomsCamera) {
    const std::size_t camera = random.below(device.device.cameras.size());
    shot.rings[camera] = see_rings(other, device.lenses[camera],
                                   place_trust_device(other, 2 * seed + 1) * device.T_rig_sensor[camera], random);
  }
  TrustSession session(device.device, map_for(trap, room, other, random));
  const calib::Outcome& outcome = session.run(shot, nullptr);
  ++tally.shots;
  if (!calib::may_write(outcome.verdict))
    ++tally.refused;
  else if (off_truth(outcome, device))
    ++tally.wrong;
  else
    ++tally.right;
}

}  // namespace roomcal::tools
