#include "drivers/os/linux_clocks.h"

#include <cerrno>
#include <ctime>

#include "drivers/os/time_ns.h"

namespace roomcal::drivers {

namespace {

constexpr clockid_t kNoClock = -1;

clockid_t system_id(ClockId clock) {
  switch (clock) {
    case ClockId::kMonotonic:
      return CLOCK_MONOTONIC;
    case ClockId::kRealtime:
      return CLOCK_REALTIME;
    case ClockId::kBoottime:
      return CLOCK_BOOTTIME;
    case ClockId::kTai:
      return CLOCK_TAI;
    case ClockId::kUnknown:
    case ClockId::kDevice:
      break;
  }
  return kNoClock;
}

}  // namespace

int64_t LinuxClocks::now_ns() const { return read(ClockId::kMonotonic).ns; }

Stamp LinuxClocks::read(ClockId clock) const {
  const clockid_t id = system_id(clock);
  timespec time{};
  if (id == kNoClock || ::clock_gettime(id, &time) != 0) return {0, clock};
  return {to_ns(time), clock};
}

void LinuxClocks::sleep_until(int64_t deadline_ns) const {
  if (deadline_ns <= 0) return;
  const timespec deadline = to_timespec(deadline_ns);
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

}  // namespace roomcal::drivers
