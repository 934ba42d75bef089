#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>

#include "drivers/relay/library_camera.h"
#include "drivers/relay/relay_options.h"
#include "runtime/base/fixed_text.h"
#include "runtime/ports/image_source.h"
#include "runtime/ports/log.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

class RelayWorker;

/// ports::ImageSource in front of a library that allocates and may hang. The library's calls are made by a thread of
/// this source; the thread that calls next() only waits for a buffer's number and copies its luminance: no heap, and
/// never longer than `wait_ns` and a copy, whatever the library does.
class RelaySource : public ports::ImageSource {
 public:
  RelaySource(std::string_view name, const RelayOptions& options, std::unique_ptr<LibraryCamera> camera,
              const ports::SystemClocks& clocks, ports::Log& log);
  ~RelaySource() override;

  std::string_view name() const override { return name_.view(); }
  Status start() override;
  Status next(int64_t wait_ns, MutableImageView into, ports::ImageFacts& facts) override;
  /// A library that does not return is left behind with its thread; start() then refuses.
  void stop() override;
  /// As of the last start(), next() or stop().
  const ports::ImageHealth& health() const override { return health_; }

  /// Makes the camera expose, where it waits for software: asks, and waits for the library to have told it. Two calls,
  /// so that several cameras are told at once; see drivers/relay/software_trigger.h. Any thread but that of stop().
  /// @return false if it does not stream, or could not be told.
  bool streams();
  bool want_fire();
  bool fired(int64_t deadline_ns);

 private:
  SensorName name_;
  RelayOptions options_;
  const ports::SystemClocks& clocks_;
  ports::Log& log_;
  std::unique_ptr<RelayWorker> worker_;  // null: left behind
  ports::ImageHealth health_;
  bool reserved_ = false;
  std::atomic<bool> running_{false};
};

}  // namespace roomcal::drivers
