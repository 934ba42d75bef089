#include "drivers/store/fd_medium.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>

namespace roomcal::drivers {

namespace {

constexpr std::size_t kFilePage = 4096;
constexpr std::size_t kEepromPage = 32;
constexpr std::size_t kMaxPath = 512;
constexpr int kMaxInterrupts = 16;

// Moves all of `size` bytes or fails; a call that a signal interrupts or that moves a part only is taken up again.
template <typename Call>
bool move_all(std::size_t size, const Call& call) {
  int interrupts = 0;
  for (std::size_t done = 0; done < size;) {
    const ssize_t moved = call(done);
    if (moved > 0) {
      done += static_cast<std::size_t>(moved);
    } else if (moved == 0) {
      errno = ENOSPC;  // neither end of file nor progress has a reason of its own
      return false;
    } else if (errno != EINTR || ++interrupts > kMaxInterrupts) {
      return false;
    }
  }
  return true;
}

bool sync_folder(const char* path) {
  std::array<char, kMaxPath> folder{};
  const char* slash = std::strrchr(path, '/');
  const std::size_t length = slash == nullptr ? 0 : static_cast<std::size_t>(slash - path);
  std::memcpy(folder.data(), path, length);
  if (length == 0) folder[0] = slash == nullptr ? '.' : '/';
  const UniqueFd fd(::open(folder.data(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  return fd.valid() && ::fsync(fd.get()) == 0;
}

}  // namespace

Status FdMedium::fail(const char* detail) {
  error_number_ = errno;
  return {StatusCode::kUnavailable, detail};
}

Status FdMedium::open(const MediumOptions& options) {
  fd_.reset();
  read_only_ = sync_failed_ = false;
  error_number_ = 0;
  kind_ = options.kind;
  page_bytes_ = options.page_bytes != 0              ? options.page_bytes
                : options.kind == MediumKind::kNvmem ? kEepromPage
                                                     : kFilePage;
  if (!std::has_single_bit(page_bytes_))
    return {StatusCode::kInvalidArgument, "the store's page size is not a power of two"};
  if (std::strlen(options.path) + 8 > kMaxPath) return {StatusCode::kInvalidArgument, "the store's path is too long"};
  return kind_ == MediumKind::kFile ? open_file(options) : open_device(options);
}

Status FdMedium::open_file(const MediumOptions& options) {
  if (options.size_bytes == 0 || options.size_bytes % page_bytes_ != 0)
    return {StatusCode::kInvalidArgument, "the store's file size is not a multiple of its page size"};
  fd_ = UniqueFd(::open(options.path, O_RDWR | O_CLOEXEC));
  if (!fd_.valid() && errno == ENOENT) {
    ROOMCAL_TRY(make_file(options));
    fd_ = UniqueFd(::open(options.path, O_RDWR | O_CLOEXEC));
  }
  if (!fd_.valid() && (errno == EROFS || errno == EACCES)) {
    fd_ = UniqueFd(::open(options.path, O_RDONLY | O_CLOEXEC));
    read_only_ = true;
  }
  if (!fd_.valid()) return fail("the store's file cannot be opened; check its path and permissions");
  struct stat info {};
  if (::fstat(fd_.get(), &info) != 0) return fail("the store's file cannot be looked at");
  if (!S_ISREG(info.st_mode) || static_cast<std::size_t>(info.st_size) != options.size_bytes)
    return {StatusCode::kInvalidArgument,
            "the store's file has another size than the board says; do not resize a store"};
  size_bytes_ = options.size_bytes;
  return ok_status();
}

Status FdMedium::fill(int fd, std::size_t size) {
  std::array<std::byte, kFilePage> blank;
  blank.fill(std::byte{0xFF});
  const bool filled = move_all(size, [&](std::size_t done) {
    return ::pwrite(fd, blank.data(), std::min(blank.size(), size - done), static_cast<off_t>(done));
  });
  if (!filled) return fail("the store's file cannot be made at its full size; free space on its disk");
  if (::fsync(fd) != 0) return fail("the store's file cannot be synced to its disk");
  return ok_status();
}

Status FdMedium::make_file(const MediumOptions& options) {
  std::array<char, kMaxPath> fresh{};
  std::snprintf(fresh.data(), fresh.size(), "%s.new", options.path);
  const UniqueFd fd(::open(fresh.data(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (!fd.valid()) return fail("the store's file cannot be made; check that its folder exists and may be written");
  if (const Status filled = fill(fd.get(), options.size_bytes); !filled.ok()) {
    ::unlink(fresh.data());
    return filled;
  }
  if (::rename(fresh.data(), options.path) != 0) return fail("the store's file cannot take its name");
  return sync_folder(options.path) ? ok_status() : fail("the store's folder cannot be synced");
}

Status FdMedium::open_device(const MediumOptions& options) {
  fd_ = UniqueFd(::open(options.path, O_RDWR | O_CLOEXEC));
  if (!fd_.valid() && (errno == EROFS || errno == EACCES)) {
    fd_ = UniqueFd(::open(options.path, O_RDONLY | O_CLOEXEC));
    read_only_ = true;
  }
  if (!fd_.valid()) return fail("the store's device cannot be opened; check its path and permissions");
  const off_t end = ::lseek(fd_.get(), 0, SEEK_END);
  if (end <= 0) return fail("the store's device does not tell its size");
  const auto there = static_cast<std::size_t>(end) / page_bytes_ * page_bytes_;
  if (options.size_bytes > there || options.size_bytes % page_bytes_ != 0)
    return {StatusCode::kInvalidArgument,
            "the store's device is smaller than the board says; size_bytes: 0 takes all of it"};
  size_bytes_ = options.size_bytes == 0 ? there : options.size_bytes;
  return ok_status();
}

Status FdMedium::read(std::size_t offset, std::span<std::byte> out) {
  if (offset > size_bytes_ || out.size() > size_bytes_ - offset)
    return {StatusCode::kOutOfRange, "read beyond the store's end"};
  const bool done = move_all(out.size(), [&](std::size_t at) {
    return ::pread(fd_.get(), out.data() + at, out.size() - at, static_cast<off_t>(offset + at));
  });
  return done ? ok_status() : fail("the store's medium cannot be read");
}

Status FdMedium::write_page(std::size_t offset, std::span<const std::byte> page) {
  if (page.size() != page_bytes_ || offset % page_bytes_ != 0 || size_bytes_ < page_bytes_ ||
      offset > size_bytes_ - page_bytes_)
    return {StatusCode::kOutOfRange, "not a page of the store"};
  if (read_only_) return {StatusCode::kUnavailable, "the store's medium is read-only"};
  const bool done = move_all(page.size(), [&](std::size_t at) {
    return ::pwrite(fd_.get(), page.data() + at, page.size() - at, static_cast<off_t>(offset + at));
  });
  return done ? ok_status() : fail("the store's medium cannot be written; check it for space and errors");
}

Status FdMedium::sync() {
  if (read_only_) return {StatusCode::kUnavailable, "the store's medium is read-only"};
  if (sync_failed_) return {StatusCode::kUnavailable, "the store's medium failed to sync before; restart the device"};
  // sysfs knows no sync: a write to it returns when the chip has taken it.
  if (::fdatasync(fd_.get()) == 0 || (kind_ == MediumKind::kNvmem && errno == EINVAL)) return ok_status();
  sync_failed_ = true;
  return fail("the store's medium failed to sync; restart the device");
}

Status FdMedium::drop_caches() {
  if (kind_ == MediumKind::kNvmem) return ok_status();  // sysfs reads the chip
  const int error = ::posix_fadvise(fd_.get(), 0, 0, POSIX_FADV_DONTNEED);
  errno = error;
  return error == 0 ? ok_status() : fail("the store's cache cannot be dropped");
}

}  // namespace roomcal::drivers
