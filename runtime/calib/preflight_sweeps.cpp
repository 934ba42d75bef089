#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/base/reason.h"
#include "runtime/calib/preflight.h"

namespace roomcal::calib {

namespace {

constexpr std::size_t kSectors = 36;
constexpr std::size_t kMinPoints = 200;
constexpr std::size_t kLooks = 4000;

struct View {
  std::size_t usable_points = 0;
  std::size_t sectors = 0;  ///< of 36, with a return
};

View look(const lidar::Sweep& sweep, double min_range_m) {
  View view;
  std::array<bool, kSectors> seen{};
  // Odd, so that a stride of the beam count does not look at one beam only.
  const std::size_t stride = std::max<std::size_t>(1, sweep.points.size() / kLooks) | 1U;
  for (std::size_t i = 0; i < sweep.points.size(); i += stride) {
    const Vec3 p_lidar = sweep.position_lidar(i);
    if (!(p_lidar.norm() >= min_range_m)) continue;  // NaN too
    ++view.usable_points;
    const double turn = std::atan2(p_lidar.y(), p_lidar.x()) / (2 * kPi) + 0.5;
    seen[std::min(kSectors - 1, static_cast<std::size_t>(turn * static_cast<double>(kSectors)))] = true;
  }
  view.usable_points *= stride;
  view.sectors = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
  return view;
}

const char* why_unusable(uint32_t flags) {
  if ((flags & lidar::kSweepLostPackets) != 0) return "packets were lost: check the network and its load";
  if ((flags & lidar::kSweepFull) != 0) return "more points than a sweep holds: set the sensor to a single return";
  if ((flags & lidar::kSweepOutOfOrder) != 0) return "packets came out of order: connect it without routers between";
  if ((flags & lidar::kSweepPartial) != 0) return "no whole turn came: record longer";
  return "its packets are damaged or of another sensor: check its model and its configuration";
}

}  // namespace

bool usable(const lidar::Sweep& sweep) { return (sweep.flags & ~static_cast<uint32_t>(lidar::kSweepDuplicates)) == 0; }

void check_sweeps(const LidarSpec& lidar, std::span<const lidar::Sweep> sweeps, const Limits& limits,
                  LidarOutcome& outcome) {
  outcome.name = lidar.name;
  outcome.sweeps = sweeps.size();
  const int n = static_cast<int>(lidar.name.view().size());
  const char* s = lidar.name.view().data();
  const lidar::Sweep* first = nullptr;
  for (const lidar::Sweep& sweep : sweeps) {
    outcome.flags |= sweep.flags;
    if (!usable(sweep)) continue;
    if (first == nullptr) first = &sweep;
    ++outcome.used_sweeps;
  }
  outcome.used_sweeps = std::min(outcome.used_sweeps, kMaxSweeps);
  if (sweeps.empty()) {
    outcome.failure = make_reason("%.*s: no packets: check its power, cable and address", n, s);
    return;
  }
  if (first == nullptr) {
    outcome.failure =
        make_reason("%.*s: none of its %zu sweeps is whole: %s", n, s, sweeps.size(), why_unusable(outcome.flags));
    return;
  }
  const View view = look(*first, lidar.ranges.min_range_m);
  if (view.usable_points < kMinPoints)
    outcome.failure = make_reason("%.*s: only %zu returns in a sweep: is it running, and its window clean?", n, s,
                                  view.usable_points);
  else if (static_cast<double>(view.sectors) < limits.min_horizon * static_cast<double>(kSectors))
    outcome.failure = make_reason(
        "%.*s: %zu degrees of its horizon are blocked: clear its view, or set min_horizon if the device blocks it", n,
        s, 10 * (kSectors - view.sectors));
}

}  // namespace roomcal::calib
