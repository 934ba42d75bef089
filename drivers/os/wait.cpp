#include "drivers/os/wait.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <poll.h>

#include "drivers/os/linux_clocks.h"
#include "drivers/os/time_ns.h"

namespace roomcal::drivers {

uint32_t wait_readable(std::span<const int> fds, int64_t deadline_ns) {
  assert(fds.size() <= kMaxWaitFds);
  std::array<pollfd, kMaxWaitFds> polled{};
  for (std::size_t i = 0; i < fds.size(); ++i) polled[i] = {fds[i], POLLIN, 0};
  const timespec left = to_timespec(std::max<int64_t>(deadline_ns - LinuxClocks().now_ns(), 0));
  if (::ppoll(polled.data(), fds.size(), &left, nullptr) <= 0) return 0;
  uint32_t ready = 0;
  for (std::size_t i = 0; i < fds.size(); ++i) ready |= (polled[i].revents != 0 ? 1U : 0U) << i;
  return ready;
}

}  // namespace roomcal::drivers
