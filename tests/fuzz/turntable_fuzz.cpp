// Angles and profiles with any numbers and stamps in any order. Whatever comes, every point is accounted for, and those
// of the sweep are as far from the axis' origin as the profiler saw them.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "runtime/lidar/turntable.h"

namespace {

using namespace roomcal;
using namespace roomcal::lidar;

void require(bool holds) {
  if (!holds) __builtin_trap();
}

class Source {
 public:
  explicit Source(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  template <typename T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof(T), bytes_.size());
    std::memcpy(&value, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return value;
  }

 private:
  std::span<const uint8_t> bytes_;
};

// Mostly the next few milliseconds, sometimes anything.
Stamp stamp_from(Source& source, int64_t& clock_ns) {
  const auto kind = source.take<uint8_t>();
  if (kind == 255) return {source.take<int64_t>(), static_cast<ClockId>(source.take<uint8_t>() % 6)};
  clock_ns += int64_t{kind} * 200'000 - 1'000'000;
  return {clock_ns, ClockId::kRealtime};
}

void check(Turntable& table, const TurntableOptions& options) {
  const Sweep& sweep = table.finish();
  const TurntableCounters& c = table.counters();
  require(c.offered == c.kept + c.thinned + c.without_angle + c.crowded_out + c.not_finite + c.beyond);
  require(sweep.points.size() == c.kept && c.kept <= options.capacity);
  require(table.whole() || (sweep.flags & kSweepPartial) != 0);
  require(sweep.duration_ns >= 0);
  const double offset_m = options.mounting.T_lidar_profiler.t.norm();
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const double seen_m = static_cast<double>(sweep.points[i].range_m), is_m = sweep.position_lidar(i).norm();
    require(std::abs(is_m - seen_m) <= offset_m + 1e-5 * seen_m + 1e-6);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  TurntableOptions options;
  options.capacity = 100;
  options.waiting = 64;
  options.angles = 16;
  options.mounting.T_lidar_profiler.t = Vec3(0.02, 0, 0);
  std::vector<std::byte> memory(Turntable::arena_bytes(options));
  Arena arena(memory);
  Turntable table = Turntable::create(options, arena).value();
  table.begin();
  Source source({data, std::min<std::size_t>(size, 8192)});
  int64_t angle_ns = 0, profile_ns = 0;
  double angle_rad = 0;
  while (!source.empty()) {
    const auto op = source.take<uint8_t>();
    if (op % 8 == 0) {
      check(table, options);
      table.begin();
    } else if (op % 2 == 0) {
      angle_rad = op % 8 == 6 ? source.take<double>() : angle_rad + 0.001 * source.take<int8_t>();
      static_cast<void>(table.add_angle({stamp_from(source, angle_ns), angle_rad}));
    } else {
      std::vector<SweepPoint> points(op / 8);
      for (SweepPoint& point : points) {
        point.x_m = source.take<float>();
        point.range_m = std::abs(point.x_m);
        point.offset_ns = source.take<uint16_t>() * 256;
      }
      Sweep profile;
      profile.points = points;
      static_cast<void>(table.add_profile(profile, stamp_from(source, profile_ns)));
    }
  }
  check(table, options);
  return 0;
}
