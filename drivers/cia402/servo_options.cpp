#include "drivers/cia402/servo_options.h"

#include <cmath>

namespace roomcal::drivers::cia402 {

namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kLargest = 2'147'483'647;
constexpr uint32_t kPdoOff = 0x8000'0000, kNoRemoteRequest = 0x4000'0000;
constexpr uint32_t kAtEverySync = 1, kAtOnce = 255;
constexpr uint32_t kMapControlword = 0x6040'0010, kMapTargetVelocity = 0x60FF'0020, kMapStatusword = 0x6041'0010,
                   kMapPosition = 0x6064'0020;
constexpr uint32_t kAbortConnectionByQuickStop = 3;

bool within(double value, double low, double high) { return value >= low && value <= high; }

void add(Setup& setup, const SetupEntry& entry) { static_cast<void>(setup.push_back(entry)); }

void add_pdo(Setup& setup, uint16_t communication, uint16_t mapping, uint32_t id, uint32_t type, uint32_t first,
             uint32_t second) {
  add(setup, {{communication, 1}, id | kPdoOff});
  add(setup, {{communication, 2}, type, 1});
  add(setup, {{mapping, 0}, 0, 1});
  add(setup, {{mapping, 1}, first});
  add(setup, {{mapping, 2}, second});
  add(setup, {{mapping, 0}, 2, 1});
  add(setup, {{communication, 1}, id});
}

uint32_t units(double value) { return static_cast<uint32_t>(std::llround(std::abs(value))); }

void add_motion(Setup& setup, const ServoOptions& options) {
  const double scale = options.acceleration_units_per_count;
  const uint32_t acceleration = units(counts_of(options, options.acceleration_radps2) * scale);
  add(setup, {{0x6083, 0}, acceleration});
  add(setup, {{0x6084, 0}, acceleration});
  add(setup, {{0x6085, 0}, acceleration, 4, true});
  if (options.homing_method == 0) return;
  const double speed = counts_of(options, options.homing_speed_radps) * options.velocity_units_per_count;
  add(setup, {{0x6098, 0}, static_cast<uint8_t>(options.homing_method), 1});
  add(setup, {{0x6099, 1}, units(speed)});
  add(setup, {{0x6099, 2}, units(speed / 4)});
  add(setup, {{0x609A, 0}, acceleration, 4, true});
}

}  // namespace

double counts_of(const ServoOptions& options, double angle_rad) { return options.counts_per_turn / kTwoPi * angle_rad; }
double angle_of(const ServoOptions& options, double counts) { return counts / options.counts_per_turn * kTwoPi; }

Status check(const ServoOptions& o) {
  const auto bad = [](const char* what) { return Status{StatusCode::kInvalidArgument, what}; };
  if (o.node_id < 1 || o.node_id > kMaxNode) return bad("a servo's node id is 1 to 127");
  if (o.own_id < 1 || o.own_id > kMaxNode || o.own_id == o.node_id)
    return bad("our own node id is 1 to 127 and not the servo's");
  if (!within(std::abs(o.counts_per_turn), 1, 1e9)) return bad("a servo's counts per turn are 1 to 1e9");
  if (!within(o.max_speed_radps, 1e-3, 1e3)) return bad("a servo's largest speed is 0.001 to 1000 rad/s");
  if (!(std::abs(counts_of(o, o.max_speed_radps) * o.velocity_units_per_count) <= kLargest))
    return bad("a servo's largest speed does not fit its velocity units");
  if (!within(o.acceleration_radps2, 1e-3, 1e4)) return bad("a servo's acceleration is 0.001 to 10000 rad/s^2");
  if (!within(std::abs(counts_of(o, o.acceleration_radps2) * o.acceleration_units_per_count), 1, kLargest))
    return bad("a servo's acceleration does not fit its units");
  if (o.homing_method != 0 && !within(o.homing_speed_radps, 1e-4, o.max_speed_radps))
    return bad("a servo's homing speed is 0.0001 to its largest");
  if (o.sync_period_ns < 1'000'000 || o.sync_period_ns > 100'000'000) return bad("a SYNC period is 1 to 100 ms");
  if (o.heartbeat_period_ns < 10'000'000 || o.heartbeat_period_ns > 10'000'000'000)
    return bad("a heartbeat period is 10 ms to 10 s");
  if (o.sdo_timeout_ns < 10'000'000 || o.homing_timeout_ns < 10'000'000)
    return bad("a servo's time-outs are 10 ms or more");
  return ok_status();
}

Setup setup_of(const ServoOptions& options) {
  Setup setup;
  const auto heartbeat_ms = static_cast<uint32_t>(options.heartbeat_period_ns / 1'000'000);
  add(setup, {{0x1017, 0}, heartbeat_ms, 2});
  add(setup, {{0x1016, 1}, uint32_t{options.own_id} << 16 | (3 * heartbeat_ms & 0xFFFF), 4, true});
  add(setup, {{0x6007, 0}, kAbortConnectionByQuickStop, 2, true});
  add(setup, {{0x1005, 0}, kSyncId, 4, true});
  add_pdo(setup, 0x1400, 0x1600, rpdo1_id(options.node_id), kAtOnce, kMapControlword, kMapTargetVelocity);
  add_pdo(setup, 0x1800, 0x1A00, tpdo1_id(options.node_id) | kNoRemoteRequest, kAtEverySync, kMapStatusword,
          kMapPosition);
  add_motion(setup, options);
  return setup;
}

}  // namespace roomcal::drivers::cia402
