#pragma once

#include <cstddef>
#include <cstdint>

#include "drivers/os/unique_fd.h"
#include "runtime/ports/medium.h"

namespace roomcal::drivers {

/// What kind of thing keeps the store's bytes.
enum class MediumKind : uint8_t {
  kFile,       ///< a file of fixed size; made if it is not there
  kPartition,  ///< a block device without a file system: /dev/mmcblk0p5
  kNvmem,      ///< an EEPROM or the like behind a sysfs file: /sys/bus/i2c/devices/0-0050/eeprom
};

struct MediumOptions {
  MediumKind kind = MediumKind::kFile;
  const char* path = "";
  std::size_t size_bytes = 0;  ///< of a file; of the others 0 means all there is
  std::size_t page_bytes = 0;  ///< 0: 4096, and 32 for nvmem (the smallest page of common I2C EEPROMs)
};

/// The store's medium on Linux: pread, pwrite and fdatasync on one descriptor.
///
/// A file is made whole before it takes its name (written full, synced, renamed, folder synced), so a full disk shows
/// at the first start and never during a commit. A process that sets RLIMIT_FSIZE ignores SIGXFSZ. After a failed sync
/// nothing is acknowledged any more until the medium is opened anew: the kernel tells a write error once and then
/// forgets it.
class FdMedium final : public ports::Medium {
 public:
  FdMedium() = default;

  /// @param options  the path is not kept.
  /// @return kUnavailable if it cannot be opened, made or sized, naming what to check (error_number() tells the
  /// system's
  ///         reason); kInvalidArgument for a size or page that cannot work, or a file of another size.
  Status open(const MediumOptions& options);

  std::size_t size_bytes() const override { return size_bytes_; }
  std::size_t page_bytes() const override { return page_bytes_; }
  Status read(std::size_t offset, std::span<std::byte> out) override;
  Status write_page(std::size_t offset, std::span<const std::byte> page) override;
  Status sync() override;
  Status drop_caches() override;

  /// errno of the last call that failed, for the log.
  int error_number() const { return error_number_; }
  bool read_only() const { return read_only_; }

 private:
  Status fail(const char* detail);
  Status open_file(const MediumOptions& options);
  Status make_file(const MediumOptions& options);
  Status fill(int fd, std::size_t size);
  Status open_device(const MediumOptions& options);

  UniqueFd fd_;
  std::size_t size_bytes_ = 0;
  std::size_t page_bytes_ = 0;
  MediumKind kind_ = MediumKind::kFile;
  bool read_only_ = false;
  bool sync_failed_ = false;
  int error_number_ = 0;
};

}  // namespace roomcal::drivers
