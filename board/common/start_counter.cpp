#include "board/common/start_counter.h"

#include <cstdio>
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

#include "drivers/os/unique_fd.h"

namespace roomcal::board {

int StartCounter::begin() {
  int count = 0;
  {
    const drivers::UniqueFd fd(::open(file_.c_str(), O_RDONLY | O_CLOEXEC));
    char text[16] = {};
    if (fd.valid() && ::read(fd.get(), text, sizeof text - 1) > 0) count = std::atoi(static_cast<const char*>(text));
  }
  if (count < 0 || count > 1000) count = 0;
  write(count + 1);
  return count;
}

void StartCounter::well() {
  if (told_) return;
  told_ = true;
  write(0);
}

// A counter that cannot be kept costs safe mode, nothing else: no error.
void StartCounter::write(int count) const {
  const std::string fresh = file_ + ".new";
  {
    const drivers::UniqueFd fd(::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    char text[16];
    const int size = std::snprintf(text, sizeof text, "%d\n", count);
    if (!fd.valid() || ::write(fd.get(), text, static_cast<std::size_t>(size)) != size || ::fsync(fd.get()) != 0)
      return;
  }
  if (std::rename(fresh.c_str(), file_.c_str()) != 0) ::unlink(fresh.c_str());
}

}  // namespace roomcal::board
