#include "tools/evaluate/shots_run.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "tools/common/error.h"
#include "tools/common/progress.h"
#include "tools/evaluate/rendered_shot.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/raster.h"

namespace roomcal::tools {

namespace {

constexpr double kRenderedScale = 0.4;  // of the cameras: 512 x 288, rings of 25 px at 1.5 m
constexpr int kShotsPerRoom = 25;       // rendered: light is worked out once for all of them

std::vector<TrustRoom> make_rooms(uint64_t seed, std::size_t count) {
  std::vector<std::optional<TrustRoom>> made(count);
  parallel_for(static_cast<int>(count), [&](int i) {
    made[static_cast<std::size_t>(i)].emplace(draw_trust_scene(seed, static_cast<uint64_t>(i)));
  });
  std::vector<TrustRoom> rooms;
  for (auto& room : made) rooms.push_back(std::move(*room));
  return rooms;
}

/// Progress of several threads.
class SharedProgress {
 public:
  SharedProgress(const char* what, std::size_t total) : progress_(what, total) {}
  void step() {
    const std::lock_guard lock(mutex_);
    progress_.step();
  }

 private:
  std::mutex mutex_;
  Progress progress_;
};

ShotKind kind_of(int shot) {
  constexpr int kCleanOneIn = 5, kAdverse = static_cast<int>(kShotKinds.size()) - 1;
  if (shot % kCleanOneIn == 0) return ShotKind::kClean;
  return kShotKinds[static_cast<std::size_t>(1 + (shot - shot / kCleanOneIn - 1) % kAdverse)];
}

TrustShot observe(const TrustRoom& room, const TrustRoom& other, const ShotSetup& setup, uint64_t seed) {
  Random random = random_stream(seed, 78);
  TrustShot shot = take_trust_shot(room, setup.device, setup.T_room_rig, setup.flaws, random);
  if (setup.elsewhere) {
    const auto& [camera, T_room_rig] = *setup.elsewhere;
    shot.rings[camera] =
        see_rings(other, setup.device.lenses[camera], T_room_rig * setup.device.T_rig_sensor[camera], random);
  }
  return shot;
}

ShotResult run_observed(const TrustRoom& room, const TrustRoom& other, const ShotSetup& setup, uint64_t seed) {
  TrustShot shot = observe(room, other, setup, seed);
  TrustSession session(setup.device.device, room.data());
  return result_of(session.run(shot, nullptr), setup.device);
}

ShotResult run_rendered(const LitScene& lit, const TrustRoom& room, const LitScene* lit_other, const ShotSetup& setup,
                        uint64_t seed) {
  RenderedShot shot = render_trust_shot(lit, room, setup.device, setup.T_room_rig, setup.flaws, seed);
  if (setup.elsewhere)
    shot.images[setup.elsewhere->camera] =
        render_camera(*lit_other, setup.device, setup.elsewhere->camera, setup.elsewhere->T_room_rig, seed);
  const RenderedShotView view(shot);
  TrustSession session(setup.device.device, room.data());
  require(session.calibrate(view.shot()), "simulated shot");
  return result_of(session.outcome(), setup.device);
}

/// Light is worked out when it is wanted: it takes seconds.
class LitRooms {
 public:
  LitRooms(const TrustRoom& plain, const TrustRoom& other) : plain_room_(plain), other_room_(other) {}
  const LitScene& plain() { return of(plain_room_, plain_); }
  const LitScene& other() { return of(other_room_, other_); }

 private:
  static const LitScene& of(const TrustRoom& room, std::unique_ptr<LitScene>& lit) {
    if (!lit) lit = std::make_unique<LitScene>(room.scene());
    return *lit;
  }

  const TrustRoom &plain_room_, &other_room_;
  std::unique_ptr<LitScene> plain_, other_;
};

bool looks_different(ShotKind kind) {
  switch (kind) {
    case ShotKind::kMarkersMoved:
    case ShotKind::kHalfDark:
    case ShotKind::kMirror:
    case ShotKind::kDoorOpen:
    case ShotKind::kOperator:
    case ShotKind::kFurniture:
      return true;
    case ShotKind::kClean:
    case ShotKind::kWrongRoom:
    case ShotKind::kLooseCamera:
    case ShotKind::kLidarBlinded:
    case ShotKind::kCameraElsewhere:
    case ShotKind::kMirroredMap:
      return false;
  }
  return true;
}

uint64_t shot_seed(uint64_t seed, std::size_t shot) { return random_stream(seed, 1000 + shot).bits() >> 24; }

/// Number `shot` of a seed, whatever the number of shots.
ShotResult run_observed_shot(const std::vector<TrustRoom>& rooms, uint64_t seed, int shot) {
  const uint64_t own = shot_seed(seed, static_cast<std::size_t>(shot));
  Random random = random_stream(own, 77);
  const std::size_t at = random.below(rooms.size()), next = (at + 1 + random.below(rooms.size() - 1)) % rooms.size();
  const ShotKind kind = kind_of(shot);
  const TrustRoom room = upset(kind, rooms[at], rooms[next], random);
  return run_observed(room, rooms[next], set_up(kind, room, rooms[next], own, 1), own);
}

}  // namespace

ShotTallies run_observed_shots(uint64_t seed, int shots, std::size_t wanted_rooms,
                               const std::function<void(int, const ShotTallies&)>& so_far) {
  constexpr int kBlock = 1000;
  const std::vector<TrustRoom> rooms = make_rooms(seed, std::min(wanted_rooms, static_cast<std::size_t>(shots) + 1));
  SharedProgress progress("shots", static_cast<std::size_t>(shots));
  ShotTallies tallies;
  for (int first = 0; first < shots; first += kBlock) {
    const int count = std::min(kBlock, shots - first);
    std::vector<ShotResult> results(static_cast<std::size_t>(count));
    parallel_for(count, [&](int i) {
      results[static_cast<std::size_t>(i)] = run_observed_shot(rooms, seed, first + i);
      progress.step();
    });
    for (int i = 0; i < count; ++i)
      tallies[static_cast<std::size_t>(kind_of(first + i))].add(results[static_cast<std::size_t>(i)]);
    if (so_far) so_far(first + count, tallies);
  }
  return tallies;
}

RenderedTallies run_rendered_shots(uint64_t seed, int shots, std::span<const ShotKind> kinds,
                                   const std::function<void(int, const RenderedTallies&)>& so_far) {
  const int groups = (shots + kShotsPerRoom - 1) / kShotsPerRoom;
  const std::vector<TrustRoom> rooms = make_rooms(seed, static_cast<std::size_t>(groups) + 1);
  SharedProgress progress("rendered shots", kinds.size() * static_cast<std::size_t>(shots));
  RenderedTallies tallies;
  for (int group = 0; group < groups; ++group) {
    const auto at = static_cast<std::size_t>(group);
    LitRooms lit(rooms[at], rooms[at + 1]);
    for (const ShotKind kind : kinds) {
      const auto k = static_cast<std::size_t>(kind);
      Random random = random_stream(seed, 500 + k * 100 + at);
      const TrustRoom room = upset(kind, rooms[at], rooms[at + 1], random);
      const auto lit_anew = looks_different(kind) ? std::make_unique<LitScene>(room.scene()) : nullptr;
      const LitScene& lit_room = lit_anew ? *lit_anew : lit.plain();
      const LitScene* lit_other = kind == ShotKind::kCameraElsewhere ? &lit.other() : nullptr;
      const int first = group * kShotsPerRoom, count = std::min(kShotsPerRoom, shots - first);
      std::vector<ShotResult> rendered(static_cast<std::size_t>(count)), observed(rendered);
      parallel_for(count, [&](int i) {
        const auto number = static_cast<std::size_t>(i);
        const uint64_t own = shot_seed(seed, 100'000 * (k + 1) + static_cast<std::size_t>(first) + number);
        const ShotSetup setup = set_up(kind, room, rooms[at + 1], own, kRenderedScale);
        rendered[number] = run_rendered(lit_room, room, lit_other, setup, own);
        observed[number] = run_observed(room, rooms[at + 1], setup, own);
        progress.step();
      });
      for (const ShotResult& result : rendered) tallies.rendered[k].add(result);
      for (const ShotResult& result : observed) tallies.observed[k].add(result);
    }
    if (so_far) so_far(std::min(shots, (group + 1) * kShotsPerRoom), tallies);
  }
  return tallies;
}

}  // namespace roomcal::tools
