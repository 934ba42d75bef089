#include "board/common/memory_plan.h"

#include "board/common/image_driver.h"
#include "board/common/packet_driver.h"
#include "board/common/stack.h"
#include "runtime/base/reason.h"
#include "runtime/console/console.h"
#include "runtime/grab/image_ring.h"
#include "runtime/grab/sweep_tray.h"
#include "runtime/grab/turntable_tray.h"
#include "runtime/store/store.h"

namespace roomcal::board {

namespace {

constexpr std::size_t kStorePage = 65'536;  // the largest that a medium may have

void add(BoardPlan& plan, std::string_view sensor, std::string_view what, std::size_t bytes) {
  PlanItem item;
  item.what.append(sensor);
  if (!sensor.empty()) item.what.append(" ");
  item.what.append(what);
  item.bytes = bytes + 64;  // what alignment may cost
  static_cast<void>(plan.items.push_back(item));
}

std::size_t pixels(const profile::CameraProfile& camera) {
  return static_cast<std::size_t>(camera.intrinsics.width_px) * static_cast<std::size_t>(camera.intrinsics.height_px);
}

Status refuse(const Reason& reason, Reason& why) {
  if (why.empty()) why = reason;
  return {StatusCode::kCapacity, "the profile asks for more than the board has"};
}

Status check_camera(const Capacities& board, const profile::CameraProfile& camera, Reason& why) {
  const Name who(camera.name);
  if (pixels(camera) <= board.image_bytes) return ok_status();
  return refuse(make_reason("%.*s: images of %d x %d are larger than this board's cameras: choose another board",
                            who.length, who.text, camera.intrinsics.width_px, camera.intrinsics.height_px),
                why);
}

Status check_lidar(const Capacities& board, const profile::LidarProfile& lidar, Reason& why) {
  const Name who(lidar.name);
  if (lidar.wiring.sweeps <= board.sweeps) return ok_status();
  return refuse(make_reason("%.*s: %u sweeps of a shot, this board has room for %zu: lower `sweeps` of its driver",
                            who.length, who.text, lidar.wiring.sweeps, board.sweeps),
                why);
}

Status check_counts(const Capacities& board, const profile::Profile& profile, std::size_t map_bytes, Reason& why) {
  if (profile.cameras.size() > board.cameras)
    return refuse(make_reason("%zu cameras, this board has room for %zu: choose another board", profile.cameras.size(),
                              board.cameras),
                  why);
  if (profile.lidars.size() > board.lidars)
    return refuse(make_reason("%zu LiDARs, this board has room for %zu: choose another board", profile.lidars.size(),
                              board.lidars),
                  why);
  if (map_bytes > board.map_bytes)
    return refuse(make_reason("map: %zu bytes, this board has room for %zu", map_bytes, board.map_bytes), why);
  return ok_status();
}

}  // namespace

std::size_t BoardPlan::total_bytes() const {
  std::size_t total = 0;
  for (const PlanItem& item : items) total += item.bytes;
  return total;
}

lidar::SweepOptions sweep_options(const Capacities& board, const profile::LidarProfile& lidar) {
  constexpr std::size_t kProfilePoints = 25'200;  // R2000: the most samples of a turn
  lidar::SweepOptions options;
  options.capacity = lidar.on_turntable ? kProfilePoints : board.sweep_points;
  return options;
}

lidar::TurntableOptions turntable_options(const Capacities& board, const profile::LidarProfile& lidar) {
  lidar::TurntableOptions options;
  options.mounting = lidar.turntable;
  options.capacity = board.sweep_points;
  return options;
}

Status plan_board(const Capacities& board, const profile::Profile& profile, const calib::Device& device,
                  const map::RoomMap& map, std::size_t map_bytes, const drivers::ReplayCursor& replay, BoardPlan& plan,
                  Reason& why) {
  plan = BoardPlan();
  plan.limit_bytes = board.limit_bytes;
  why.clear();
  Status fits = check_counts(board, profile, map_bytes, why);
  add(plan, {}, "map", map_bytes);
  for (const profile::CameraProfile& camera : profile.cameras) {
    if (const Status checked = check_camera(board, camera, why); fits.ok()) fits = checked;
    add(plan, camera.name.view(), "images",
        grab::ImageRing::bytes(camera.intrinsics.width_px, camera.intrinsics.height_px, board.image_slots));
    add(plan, camera.name.view(), "stack", stack_bytes(board.camera_stack));
    const std::size_t recorded = ImageDriver::memory_bytes(camera, replay);
    if (recorded > 0) add(plan, camera.name.view(), "recordings", recorded);
  }
  for (const profile::LidarProfile& lidar : profile.lidars) {
    if (const Status checked = check_lidar(board, lidar, why); fits.ok()) fits = checked;
    const lidar::SweepOptions cut = sweep_options(board, lidar);
    add(plan, lidar.name.view(), "sweeps",
        lidar.on_turntable ? grab::TurntableTray::bytes(cut, turntable_options(board, lidar))
                           : grab::SweepTray::bytes(cut, lidar.wiring.sweeps));
    const std::size_t packets = PacketDriver::memory_bytes(lidar, replay);
    add(plan, lidar.name.view(), "packets", packets);
  }
  if (!profile.lidars.empty()) add(plan, {}, "packet stack", stack_bytes(board.lidar_stack));
  add(plan, {}, "session stack", stack_bytes(board.press_stack));
  plan.session = calib::plan_memory(device, map);
  add(plan, "session", "permanent", plan.session.permanent_bytes);
  add(plan, "session", "step", plan.session.step_bytes);
  add(plan, "session", "scratch", plan.session.scratch_bytes);
  const std::size_t page = profile.wiring.store.page_bytes != 0 ? profile.wiring.store.page_bytes : 4096;
  add(plan, {}, "store", store::plan_store_bytes(std::min(page, kStorePage)));
  if (plan.total_bytes() > board.limit_bytes && fits.ok())
    fits = refuse(make_reason("%zu bytes in all, this board has %zu: fewer sweeps or recordings, or another board",
                              plan.total_bytes(), board.limit_bytes),
                  why);
  return fits;
}

}  // namespace roomcal::board
