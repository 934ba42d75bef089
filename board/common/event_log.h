#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "runtime/base/fixed_text.h"
#include "runtime/ports/log.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::board {

/// The last lines of what happened, oldest overwritten first; also to standard error, where the service manager keeps
/// them. From any thread; a short lock, no heap.
class EventLog final : public ports::Log {
 public:
  static constexpr std::size_t kLines = 128;

  /// @param to_stderr  off where standard error is the console.
  EventLog(const ports::SystemClocks& clocks, bool to_stderr) : clocks_(clocks), to_stderr_(to_stderr) {}

  void note(std::string_view who, std::string_view what) override;

  /// The last lines, oldest first. @param visit  gets "12.345 cam0: ...".
  void read(std::size_t lines, void (*visit)(void* context, std::string_view line), void* context) const;
  uint64_t count() const;

 private:
  using Line = FixedText<220>;

  const ports::SystemClocks& clocks_;
  bool to_stderr_;
  mutable std::mutex mutex_;
  std::array<Line, kLines> lines_;
  uint64_t count_ = 0;
};

}  // namespace roomcal::board
