#include "board/common/start_counter.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "drivers/os/unique_fd.h"

namespace roomcal::board {

namespace {

constexpr std::size_t kBootId = 36;        // a UUID
constexpr std::string_view kNoBoot = "-";  // where the kernel tells none: every start then counts

/// The beginning of a small file; empty if it cannot be read.
std::string head_of(const char* path) {
  const drivers::UniqueFd fd(::open(path, O_RDONLY | O_CLOEXEC));
  char text[80] = {};
  const ssize_t size = fd.valid() ? ::read(fd.get(), text, sizeof text - 1) : 0;
  return {text, static_cast<std::size_t>(size > 0 ? size : 0)};
}

}  // namespace

std::string boot_id() { return head_of("/proc/sys/kernel/random/boot_id").substr(0, kBootId); }

int StartCounter::begin() {
  int count = 0;
  char boot[kBootId + 1] = {}, how[8] = {};
  const int words = std::sscanf(head_of(file_.c_str()).c_str(), "%d %36s %7s", &count, boot, how);
  if (words < 1 || count < 0 || count > 1000) count = 0;
  const bool another_boot = words >= 2 && !boot_.empty() && boot != kNoBoot && boot_ != boot;
  const bool power_cut = another_boot && std::strcmp(how, "hung") != 0;
  if (power_cut && count > 0) --count;
  count_ = count + 1;
  write(count_, false);
  return count;
}

void StartCounter::well() {
  if (told_) return;
  told_ = true;
  count_ = 0;
  write(0, false);
}

// One that was well for a while and then hangs is the first of a row.
void StartCounter::hangs(bool now) { write(now ? std::max(count_, 1) : count_, now); }

// A counter that cannot be kept costs safe mode, nothing else: no error.
void StartCounter::write(int count, bool hung) const {
  const std::string fresh = file_ + ".new";
  {
    const drivers::UniqueFd fd(::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    char text[80];
    const int size = std::snprintf(text, sizeof text, "%d %s %s\n", count,
                                   boot_.empty() ? kNoBoot.data() : boot_.c_str(), hung ? "hung" : "runs");
    if (!fd.valid() || ::write(fd.get(), text, static_cast<std::size_t>(size)) != size || ::fsync(fd.get()) != 0)
      return;
  }
  if (std::rename(fresh.c_str(), file_.c_str()) != 0) ::unlink(fresh.c_str());
}

}  // namespace roomcal::board
