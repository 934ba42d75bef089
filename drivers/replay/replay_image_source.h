#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "drivers/image/health_log.h"
#include "drivers/replay/replay_cursor.h"
#include "runtime/ports/image_source.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

struct ReplayImageOptions {
  SensorName name = {};             ///< the file is `<name>.pgm`
  int width_px = 0, height_px = 0;  ///< of every image
  int64_t period_ns = 100'000'000;  ///< the camera's rate
};
static_assert(std::is_trivially_copyable_v<ReplayImageOptions>);

/// A camera that shows the images of a folder: 8-bit binary PGM, one a shot, each again and again at the camera's rate.
/// Stamped on the monotonic clock at whole periods since the cursor's epoch; sources of equal periods agree to the
/// nanosecond. What nobody asks for is not exposed: nothing is lost or superseded.
class ReplayImageSource final : public ports::ImageSource {
 public:
  /// Bytes that the source wants: the pixels of every shot.
  static std::size_t memory_bytes(const ReplayImageOptions& options, int shots);

  /// @param memory  for the images, read at start(). All references must outlive the source.
  ReplayImageSource(const ReplayImageOptions& options, const ReplayCursor& cursor, const ports::SystemClocks& clocks,
                    ports::Log& log, std::span<std::byte> memory)
      : options_(options), cursor_(cursor), clocks_(clocks), health_(options.name.view(), log), memory_(memory) {}

  std::string_view name() const override { return options_.name.view(); }
  /// @return also kOutOfMemory if the memory is smaller than memory_bytes(); kUnsupported for files that are no such
  /// PGM
  ///         or of another size; kNotFound for one that is missing: next() then looks again every second.
  Status start() override;
  Status next(int64_t wait_ns, MutableImageView into, ports::ImageFacts& facts) override;
  void stop() override;
  const ports::ImageHealth& health() const override { return health_.health(); }

 private:
  Status load();
  Status load_shot(int shot);
  Status retry(int64_t deadline_ns);
  Status fail(ports::ImageFault fault, Status status);
  std::span<std::byte> pixels(int shot) const;
  void copy(int shot, MutableImageView into) const;

  ReplayImageOptions options_;
  const ReplayCursor& cursor_;
  const ports::SystemClocks& clocks_;
  HealthLog health_;
  std::span<std::byte> memory_;
  bool loaded_ = false;
  int64_t retry_at_ns_ = 0;
  int64_t last_tick_ = -1;  ///< periods since the epoch, of the last image
  uint32_t sequence_ = 0;
};

}  // namespace roomcal::drivers
