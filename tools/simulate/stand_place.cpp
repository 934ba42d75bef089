#include "tools/simulate/stand_place.h"

#include <cmath>

#include <Eigen/Geometry>

#include "tools/common/error.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/ray.h"
#include "tools/simulate/room_walls.h"

namespace roomcal::tools {

namespace {

/// Camera axes x right, y down, z forward, looking along `yaw` with the horizon level, then pitched and rolled.
Mat33 upright(double yaw_rad, double pitch_rad, double roll_rad) {
  Mat33 R_room_level;
  R_room_level.col(2) = Vec3(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  R_room_level.col(1) = -Vec3::UnitZ();
  R_room_level.col(0) = R_room_level.col(1).cross(R_room_level.col(2));
  return R_room_level * so3_exp(pitch_rad * Vec3::UnitX()) * so3_exp(roll_rad * Vec3::UnitZ());
}

bool stands_free(const Scene& scene, const Vec3& place) {
  constexpr double kBodyOfDevice_m = 0.35;
  for (const Body& body : scene.bodies) {
    if (clearance(body, place) < kBodyOfDevice_m) return false;
  }
  return true;
}

/// Where a level look goes farthest, of some directions.
double deepest_yaw_rad(const Scene& scene, const Vec3& place) {
  constexpr int kDirections = 36;
  double farthest_m = 0, yaw_rad = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double turn = 2 * kPi * i / kDirections;
    const Hit hit = cast_ray(scene, place, {std::cos(turn), std::sin(turn), 0});
    if (hit.plane == nullptr || hit.distance <= farthest_m) continue;
    farthest_m = hit.distance;
    yaw_rad = turn;
  }
  return yaw_rad;
}

SE3 draw_place_in_layout(const Scene& scene, const PaperDevice& device, Random& random) {
  constexpr double kOff_m = 0.6, kOffAcross_m = 0.36;
  const double height_m = device.height_m + random.uniform(-0.1, 0.1);
  const Vec3 place = draw_free_place(scene, height_m, device.looks_across ? kOffAcross_m : kOff_m, random);
  const double yaw =
      device.looks_across ? deepest_yaw_rad(scene, place) + random.uniform(-0.2, 0.2) : random.uniform(-kPi, kPi);
  const double pitch = deg_to_rad(device.pitch_deg + random.uniform(-3, 3));
  return {upright(yaw, pitch, deg_to_rad(random.uniform(-3, 3))), place};
}

SE3 draw_place_in_box(const Scene& scene, const PaperDevice& device, Random& random) {
  constexpr int kTries = 1000;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Vec2 share = device.looks_across ? Vec2(random.uniform(0.12, 0.3), random.uniform(0.12, 0.3))
                                           : Vec2(random.uniform(0.35, 0.65), random.uniform(0.35, 0.65));
    Vec2 corner(random.uniform() < 0.5 ? 1 : 0, random.uniform() < 0.5 ? 1 : 0);
    if (!device.looks_across) corner.setZero();
    const Vec2 at = (corner - share).cwiseAbs().cwiseProduct(scene.size.head<2>());
    const Vec3 place(at.x(), at.y(), device.height_m + random.uniform(-0.1, 0.1));
    const Vec2 to_middle = scene.size.head<2>() / 2 - at;
    const double yaw = device.looks_across ? std::atan2(to_middle.y(), to_middle.x()) + random.uniform(-0.2, 0.2)
                                           : random.uniform(-kPi, kPi);
    const double pitch = deg_to_rad(device.pitch_deg + random.uniform(-3, 3));
    const double roll = deg_to_rad(random.uniform(-3, 3));
    if (stands_free(scene, place)) return {upright(yaw, pitch, roll), place};
  }
  throw ToolError("simulate shot: no free place for the device; make the room larger or emptier");
}

}  // namespace

SE3 draw_place(const Scene& scene, const PaperDevice& device, Random& random) {
  return scene.bounded() ? draw_place_in_layout(scene, device, random) : draw_place_in_box(scene, device, random);
}

}  // namespace roomcal::tools
