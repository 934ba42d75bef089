#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "drivers/image/recovery.h"
#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/ports/image_source.h"
#include "runtime/ports/log.h"

namespace roomcal::drivers {

/// Keeps one camera's ports::ImageHealth, and writes one line per distinct fault: "short image; check the cable ...".
/// The line is written again only after kQuietNs and kQuietImages without that fault, which is told too, with the
/// count: a cable that fails a hundred times a second makes two lines.
class HealthLog {
 public:
  static constexpr int64_t kQuietNs = 10'000'000'000;
  static constexpr uint64_t kQuietImages = 100;

  /// @param who  as in the profile. @param log  outlives this.
  HealthLog(std::string_view who, ports::Log& log) : who_(who), log_(log) {}

  /// All counters to zero.
  void start();
  /// An image is handed over. @param lost  numbers that never came since the one before.
  void image(uint32_t lost, int64_t now_ns);
  /// A whole image was put back for a newer one.
  void superseded() { ++health_.superseded; }
  /// @param error_number  errno that came with it; 0: none.
  void fault(ports::ImageFault fault, int64_t now_ns, int error_number = 0);
  /// A step is carried out. Counts restarts, reopens, port resets; kGiveUp writes a line, once.
  void step(RecoveryStep step);
  void state(ports::SourceState state) { health_.state = state; }
  /// A line that is no fault.
  void note(std::string_view what) { log_.note(who(), what); }
  /// The same, but not again since start(): for what every reopening would say again. Up to 16 different ones are
  /// known.
  void note_once(std::string_view what);

  std::string_view who() const { return who_.view(); }
  const ports::ImageHealth& health() const { return health_; }

 private:
  struct Row {
    bool told = false;
    uint32_t count = 0;  // since it was told
    int64_t last_ns = 0;
    uint64_t last_images = 0;  // that had been handed over
  };

  void tell_what_is_over(int64_t now_ns);

  SensorName who_;
  ports::Log& log_;
  ports::ImageHealth health_;
  std::array<Row, ports::kImageFaults> rows_{};
  FixedVector<uint32_t, 16> notes_;  // checksums
  int told_ = 0;
  bool gave_up_ = false;
};

}  // namespace roomcal::drivers
