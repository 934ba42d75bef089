#include "drivers/replay/file.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/stat.h>

namespace roomcal::drivers {

InputFile::InputFile(const char* path) : fd_(::open(path, O_RDONLY | O_CLOEXEC)) {
  struct stat info {};
  if (fd_.valid() && (::fstat(fd_.get(), &info) != 0 || !S_ISREG(info.st_mode))) fd_.reset();
  if (fd_.valid()) size_ = static_cast<std::size_t>(info.st_size);
}

bool InputFile::read(std::size_t at, std::span<std::byte> into) const {
  while (!into.empty()) {
    const ssize_t got = ::pread(fd_.get(), into.data(), into.size(), static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += static_cast<std::size_t>(got);
    into = into.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

}  // namespace roomcal::drivers
