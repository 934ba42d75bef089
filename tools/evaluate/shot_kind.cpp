#include "tools/evaluate/shot_kind.h"

#include <cmath>
#include <utility>

#include "tools/simulate/furniture.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/upset.h"

namespace roomcal::tools {

namespace {

Vec3 direction(Random& random) { return Vec3(random.normal(), random.normal(), random.normal()).normalized(); }

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

/// Some of the sheets by some centimetres, or most of them by some millimetres.
void move_some_sheets(Random& random, Scene& scene) {
  const bool few = random.uniform() < 0.5;
  move_sheets(few ? random.uniform(0.05, 0.5) : random.uniform(0.5, 1),
              few ? random.uniform(0.01, 0.1) : random.uniform(0.003, 0.02), random, scene);
}

/// A bracket has given way, by a little or by a lot, since the mounting was drawn.
void loosen_camera(TrustDevice& device, Random& random) {
  const std::size_t camera = random.below(device.device.cameras.size());
  Vec6 xi;
  xi.head<3>() = random.uniform(0.005, 0.06) * direction(random);
  xi.tail<3>() = deg_to_rad(random.uniform(0.5, 12)) * direction(random);
  const SE3 moved = se3_exp(xi);
  if (camera == 0) {  // it is the rig: all others have moved against it
    for (std::size_t i = 1; i < device.T_rig_sensor.size(); ++i)
      device.T_rig_sensor[i] = moved * device.T_rig_sensor[i];
  } else {
    device.T_rig_sensor[camera] = device.T_rig_sensor[camera] * moved;
  }
}

/// One or all of the LiDARs see next to nothing, or something stands before them.
TrustFlaws blind(std::size_t lidars, Random& random) {
  TrustFlaws flaws;
  flaws.lidars.resize(lidars);
  const std::size_t spared = random.uniform() < 0.5 ? random.below(lidars) : lidars;
  for (std::size_t i = 0; i < lidars; ++i) {
    const double share = random.uniform(0.3, 1), from = random.uniform();
    const bool dropout = random.uniform() < 0.5;
    if (i == spared) continue;
    if (dropout) {
      flaws.lidars[i].dropout = share;
    } else {
      flaws.lidars[i].blocked_from_rad = 2 * kPi * (1 - share) * from;
      flaws.lidars[i].blocked_to_rad = flaws.lidars[i].blocked_from_rad + 2 * kPi * share;
    }
  }
  return flaws;
}

}  // namespace

const char* to_string(ShotKind kind) {
  switch (kind) {
    case ShotKind::kClean:
      return "clean";
    case ShotKind::kMarkersMoved:
      return "moved markers";
    case ShotKind::kHalfDark:
      return "half the room dark";
    case ShotKind::kWrongRoom:
      return "wrong room";
    case ShotKind::kMirror:
      return "mirror on a wall";
    case ShotKind::kDoorOpen:
      return "door open that was closed";
    case ShotKind::kOperator:
      return "operator in view";
    case ShotKind::kFurniture:
      return "furniture that came later";
    case ShotKind::kLooseCamera:
      return "one camera loose";
    case ShotKind::kLidarBlinded:
      return "LiDAR blinded";
    case ShotKind::kCameraElsewhere:
      return "one camera in another room";
    case ShotKind::kMirroredMap:
      return "map with one wall mirrored";
  }
  return "";
}

Scene draw_trust_scene(uint64_t seed, uint64_t number) {
  Random random = random_stream(seed, 80 + number);
  RoomOptions options;
  options.seed = random.bits() >> 32;
  options.size = {random.uniform(2.7, 4.5), random.uniform(3, 6), random.uniform(2.4, 3)};
  const Vec3& size = options.size;
  const double papered_m2 = size.x() * size.y() + 2 * size.z() * (size.x() + size.y());
  options.markers = static_cast<int>(papered_m2 * random.uniform(5, 6.5));
  return make_room(options);
}

TrustRoom upset(ShotKind kind, const TrustRoom& room, const TrustRoom& other, Random& random) {
  Scene scene = room.scene();
  MapData map = kind == ShotKind::kWrongRoom     ? other.data()
                : kind == ShotKind::kMirroredMap ? with_mirrored_wall(room.data(), random)
                                                 : room.data();
  if (kind == ShotKind::kMarkersMoved) move_some_sheets(random, scene);
  if (kind == ShotKind::kHalfDark) darken_half(random, scene);
  if (kind == ShotKind::kMirror) hang_mirror(random, scene);
  if (kind == ShotKind::kDoorOpen) open_door(random, scene);
  if (kind == ShotKind::kOperator) stand_operator(random, scene);
  if (kind == ShotKind::kFurniture) add_furniture(static_cast<int>(2 + random.below(7)), random, scene);
  return {std::move(scene), std::move(map)};
}

ShotSetup set_up(ShotKind kind, const TrustRoom& room, const TrustRoom& other, uint64_t seed, double scale) {
  Random random = random_stream(seed, 79);
  ShotSetup setup{make_trust_device(room, 2 * seed, {.scale = scale}), place_trust_device(room, 2 * seed + 1), {}, {}};
  if (kind == ShotKind::kLooseCamera) loosen_camera(setup.device, random);
  if (kind == ShotKind::kLidarBlinded) setup.flaws = blind(setup.device.device.lidars.size(), random);
  if (kind == ShotKind::kCameraElsewhere)
    setup.elsewhere = {random.below(setup.device.device.cameras.size()), place_trust_device(other, 2 * seed + 1)};
  return setup;
}

}  // namespace roomcal::tools
