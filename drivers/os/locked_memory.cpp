#include "drivers/os/locked_memory.h"

#include <cstdint>
#include <utility>

#include <sys/mman.h>
#include <unistd.h>

namespace roomcal::drivers {

LockedMemory::LockedMemory(LockedMemory&& other) noexcept
    : bytes_(std::exchange(other.bytes_, {})), lock_status_(other.lock_status_) {}

LockedMemory& LockedMemory::operator=(LockedMemory&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(lock_status_, other.lock_status_);
  return *this;
}

void LockedMemory::release() {
  if (!bytes_.empty()) ::munmap(bytes_.data(), bytes_.size());
  bytes_ = {};
}

Status LockedMemory::reserve(std::size_t bytes) {
  release();
  if (bytes == 0) return {StatusCode::kInvalidArgument, "a memory block of no bytes"};
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  if (bytes > SIZE_MAX - page) return {StatusCode::kOutOfMemory, "no system has so much memory"};
  const std::size_t size = (bytes + page - 1) / page * page;
  void* block = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (block == MAP_FAILED) return {StatusCode::kOutOfMemory, "the system does not have the memory of the board's plan"};
  bytes_ = {static_cast<std::byte*>(block), size};
  lock_status_ =
      ::mlock(block, size) == 0
          ? ok_status()
          : Status{StatusCode::kUnavailable, "memory is not locked; raise LimitMEMLOCK= of the service or ulimit -l"};
  // Locking brings the pages in; where it was refused, writing does.
  for (std::size_t at = 0; at < size; at += page) *(static_cast<volatile std::byte*>(block) + at) = std::byte{0};
  return ok_status();
}

}  // namespace roomcal::drivers
