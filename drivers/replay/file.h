#pragma once

#include <cstddef>
#include <span>

#include "drivers/os/unique_fd.h"

namespace roomcal::drivers {

/// A file that is read into memory. No heap.
class InputFile {
 public:
  explicit InputFile(const char* path);

  bool found() const { return fd_.valid(); }
  std::size_t size() const { return size_; }
  /// @return false if not all of `into` could be read from there on.
  bool read(std::size_t at, std::span<std::byte> into) const;

 private:
  UniqueFd fd_;
  std::size_t size_ = 0;
};

}  // namespace roomcal::drivers
