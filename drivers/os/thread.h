#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include <pthread.h>

#include "drivers/os/locked_memory.h"
#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

struct ThreadOptions {
  FixedText<15> name = {};               ///< as ps -L shows it
  std::size_t stack_bytes = 256 * 1024;  ///< of an own stack, its guard page included; unused where memory is given
  int fifo_priority = 0;                 ///< 1 (lowest) to 99: real-time (SCHED_FIFO); 0: an ordinary thread
};
static_assert(std::is_trivially_copyable_v<ThreadOptions>);

/// A thread on a stack of fixed size that is in memory from the start. Its lowest page is a guard: an overflow ends the
/// process there instead of writing into somebody else's data. The rest is painted, so that stack_peak() can tell how
/// deep the thread has ever been. The C library takes some heap in start(), none afterwards.
class Thread {
 public:
  /// What the thread does. It ends by returning; how it is told to, is its own affair.
  class Body {
   public:
    virtual ~Body() = default;
    virtual void run() = 0;
  };

  Thread() = default;
  ~Thread() { join(); }
  Thread(const Thread&) = delete;
  Thread& operator=(const Thread&) = delete;

  /// @param body  must outlive the thread.
  /// @param stack  page-aligned, as LockedMemory gives it; must outlive the thread. Empty: an own one is mapped.
  /// @return kInvalidArgument for a stack that is too small or not aligned; kOutOfMemory; kUnavailable if the system
  ///         allows no further thread or this one runs already.
  Status start(const ThreadOptions& options, Body& body, std::span<std::byte> stack = {});

  /// Waits until the body has returned; does nothing without a thread.
  void join();
  bool joinable() const { return running_; }

  /// Whether it got its priority. @return kUnavailable with the limit to raise; the thread then runs as an ordinary
  /// one.
  Status priority_status() const { return priority_status_; }

  /// Usable bytes, and how many of them were used at the deepest so far (with some kB of the C library's own at the
  /// top). Valid until the next start(), from any thread. Cost: one pass over what is unused.
  std::size_t stack_bytes() const { return stack_.size(); }
  std::size_t stack_peak() const;

 private:
  Status take_stack(const ThreadOptions& options, std::span<std::byte> given);
  Status launch();
  void set_priority(int fifo_priority);
  static void* enter(void* self);

  FixedText<15> name_;
  Body* body_ = nullptr;
  LockedMemory own_;
  std::span<std::byte> guard_, stack_;
  pthread_t thread_{};
  bool running_ = false;
  Status priority_status_;
};

}  // namespace roomcal::drivers
