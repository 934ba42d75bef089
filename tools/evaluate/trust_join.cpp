#include "tools/evaluate/trust_join.h"

#include <fmt/core.h>

#include "tools/join/join_shots.h"
#include "tools/map/noise.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {

namespace {

constexpr double kMove_m = 0.005, kMove_deg = 0.3;

Vec3 direction(Random& random) { return Vec3(random.normal(), random.normal(), random.normal()).normalized(); }

SE3 draw_motion(Random& random) {
  Vec6 xi = Vec6::Zero();
  if (random.uniform() < 0.5)
    xi.head<3>() = kMove_m * direction(random);
  else
    xi.tail<3>() = deg_to_rad(kMove_deg) * direction(random);
  return se3_exp(xi);
}

/// Whether a reason says that a sensor is not where it was, and names this one.
bool says_moved(const calib::Outcome& outcome, const std::string& name) {
  for (const Reason& reason : outcome.reasons) {
    const std::string_view text = reason.view();
    if (text.find("not in the same place in all shots") != text.npos && text.substr(0, name.size()) == name)
      return true;
  }
  return false;
}

MapData map_of(const TrustRoom& room, double sigma_m, uint64_t seed) {
  MapData data = room.data();
  if (sigma_m > 0) add_noise(data, sigma_m, seed, true);
  return data;
}

}  // namespace

void run_join_trial(const TrustRoom& room, uint64_t seed, const TrustDeviceOptions& options, JoinTally& tally) {
  Random random = random_stream(seed, 91);
  TrustDevice device = make_trust_device(room, seed, options);
  TrustSession session(device.device, map_of(room, tally.map_sigma_m, seed));
  ShotJoiner unmoved(session.session()), moved(session.session());
  for (std::size_t s = 0; s < tally.shots_each; ++s) {
    const SE3 T_room_rig = place_trust_device(room, 1000 * seed + s);
    TrustShot shot = take_trust_shot(room, device, T_room_rig, {}, random);
    const calib::Outcome& outcome = session.run(shot, nullptr);
    unmoved.add(fmt::format("shot {}", s), outcome);
    if (s == 0) add_pairs(outcome, device, tally.alone);
    if (s == 0 && calib::may_write(outcome.verdict)) ++tally.alone_passed;
    if (s + 1 < tally.shots_each) moved.add(fmt::format("shot {}", s), outcome);
  }
  const calib::Outcome& joined = unmoved.join();
  ++tally.trials;
  if (calib::may_write(joined.verdict)) ++tally.joined_passed;
  if (unmoved.p_value() < calib::Limits().moved_p_value) ++tally.false_alarms;
  add_pairs(joined, device, tally.joined);

  const std::size_t sensor = random.below(device.sensors());
  device.T_rig_sensor[sensor] = device.T_rig_sensor[sensor] * draw_motion(random);
  TrustShot last = take_trust_shot(room, device, place_trust_device(room, 1000 * seed + tally.shots_each), {}, random);
  moved.add("last shot", session.run(last, nullptr));
  const calib::Outcome& contradicted = moved.join();
  ++tally.moved;
  if (!calib::may_write(contradicted.verdict)) ++tally.refused;
  if (says_moved(contradicted, device.name(sensor))) ++tally.named;
}

}  // namespace roomcal::tools
