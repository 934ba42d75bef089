#include "tools/evaluate/trust_map_noise.h"

#include "tools/map/noise.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {

void run_map_noise_trial(const TrustRoom& room, uint64_t seed, MapNoiseTally& tally) {
  Random random = random_stream(seed, 90);
  const TrustDevice device = make_trust_device(room, seed);
  TrustShot shot = take_trust_shot(room, device, place_trust_device(room, 2 * seed + 1), {}, random);
  MapData data = room.data();
  if (tally.sigma_m > 0) add_noise(data, tally.sigma_m, seed, true);
  TrustSession session(device.device, data);
  const calib::Outcome& outcome = session.run(shot, nullptr);
  ++tally.shots;
  if (calib::may_write(outcome.verdict)) ++tally.passed;
  add_pairs(outcome, device, tally.pairs);
}

}  // namespace roomcal::tools
