#pragma once

#include <array>
#include <cstdint>

#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "drivers/os/unique_fd.h"

namespace roomcal::drivers::test {

/// Whether a user-mode emulator answers for the kernel (qemu-user): it knows few socket options, SO_MEMINFO not among
/// them, which every kernel since 4.12 has; and the emulator's own page faults are counted with the program's.
inline bool emulated() {
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM, 0));
  std::array<uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t size = sizeof info;
  return ::getsockopt(fd.get(), SOL_SOCKET, SO_MEMINFO, info.data(), &size) != 0 || size < sizeof info;
}

}  // namespace roomcal::drivers::test
