#include "runtime/press/look.h"

#include <algorithm>
#include <array>

#include "runtime/base/reason.h"
#include "runtime/calib/preflight.h"
#include "runtime/marker/detector.h"

namespace roomcal::press {

namespace {

constexpr int64_t kImageWait_ns = 1'500'000'000, kSweepWait_ns = 2'000'000'000, kPoll_ns = 2'000'000;
constexpr std::size_t kSectors = 36;

double saturated_share(ImageView image) {
  std::size_t white = 0, looked = 0;
  for (int y = 0; y < image.height(); y += 4) {
    const uint8_t* row = image.row(y);
    for (int x = 0; x < image.width(); x += 4, ++looked) white += row[x] == 255 ? 1 : 0;
  }
  return looked == 0 ? 0 : static_cast<double>(white) / static_cast<double>(looked);
}

void measure(const lidar::Sweep& sweep, Sight& sight) {
  std::array<bool, kSectors> seen{};
  sight.points = sweep.points.size();
  sight.flags = sweep.flags;
  for (const lidar::SweepPoint& point : sweep.points) {
    const double range_m = static_cast<double>(point.range_m);
    sight.nearest_m = sight.nearest_m == 0 ? range_m : std::min(sight.nearest_m, range_m);
    sight.farthest_m = std::max(sight.farthest_m, range_m);
    const double turn = static_cast<double>(point.azimuth_rad) / (2 * kPi);
    seen[std::min(kSectors - 1, static_cast<std::size_t>(std::max(0.0, turn) * static_cast<double>(kSectors)))] = true;
  }
  sight.horizon = static_cast<double>(std::count(seen.begin(), seen.end(), true)) / static_cast<double>(kSectors);
}

}  // namespace

void Look::run(std::size_t sensor) {
  sight_ = Sight();
  const std::size_t cameras = device_.cameras.size();
  if (sensor < cameras) return look_at_camera(sensor);
  if (sensor < cameras + device_.lidars.size()) look_at_lidar(sensor - cameras);
}

void Look::look_at_camera(std::size_t camera) {
  sight_.sensor = device_.cameras[camera].name;
  const int64_t begin_ns = clocks_.now_ns();
  auto images = sources_.cameras[camera].ring->hold_since(begin_ns);
  while (images.empty() && clocks_.now_ns() - begin_ns < kImageWait_ns) {
    clocks_.sleep_until(clocks_.now_ns() + kPoll_ns);
    images = sources_.cameras[camera].ring->hold_since(begin_ns);
  }
  if (images.empty()) {
    sight_.complaint = calib::check_image(device_.cameras[camera], {});
    return;
  }
  const ImageView luma = images[0].luma;
  sight_.came = true;
  sight_.complaint = calib::check_image(device_.cameras[camera], luma);
  const calib::Levels levels = calib::sample_levels(luma);
  sight_.low = levels.low;
  sight_.mean = levels.mean;
  sight_.high = levels.high;
  sight_.saturated = saturated_share(luma);
  const Arena::Scope scope(arenas_.step);
  const std::span<marker::Detection> rings = arenas_.step.allocate<marker::Detection>(calib::kMaxDetections);
  const int64_t detect_ns = clocks_.now_ns();
  std::size_t count = 0;
  // Also with more rings than there is room for, and with none: what was found is told.
  static_cast<void>(marker::detect(luma, {}, arenas_.scratch, rings, count));
  sight_.detect_ms = static_cast<double>(clocks_.now_ns() - detect_ns) * 1e-6;
  sight_.rings = count;
  sight_.usable_rings = static_cast<std::size_t>(
      std::count_if(rings.begin(), rings.begin() + static_cast<std::ptrdiff_t>(count),
                    [](const marker::Detection& ring) { return ring.status == marker::DetectionStatus::kOk; }));
  for (const grab::HeldImage& image : images) sources_.cameras[camera].ring->release(image);
}

void Look::look_at_lidar(std::size_t lidar) {
  sight_.sensor = device_.lidars[lidar].name;
  sight_.camera = false;
  grab::SweepSource& tray = *sources_.lidars[lidar].tray;
  const int64_t begin_ns = clocks_.now_ns();
  tray.ask(1);
  while (!tray.full() && clocks_.now_ns() - begin_ns < kSweepWait_ns) clocks_.sleep_until(clocks_.now_ns() + kPoll_ns);
  while (!tray.stop()) clocks_.sleep_until(clocks_.now_ns() + kPoll_ns);
  sight_.came = !tray.sweeps().empty();
  if (sight_.came) measure(tray.sweeps()[0], sight_);
  calib::LidarOutcome checked;
  calib::check_sweeps(device_.lidars[lidar], tray.sweeps(), limits_, checked);
  sight_.complaint = checked.failure;
  if (!sight_.came && tray.discarded() > 0) {
    const Name who(sight_.sensor);
    sight_.flags = tray.discarded_flags();
    sight_.complaint = make_reason("%.*s: %u sweeps came and none was whole: see `sensors` for losses", who.length,
                                   who.text, tray.discarded());
  }
}

}  // namespace roomcal::press
