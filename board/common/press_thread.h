#pragma once

#include <atomic>

#include "board/common/sensor_threads.h"
#include "drivers/os/thread.h"
#include "runtime/press/look.h"
#include "runtime/press/press.h"

namespace roomcal::board {

/// The thread that computes: one press or one look at a time, asked for by the supervisor.
class PressThread final : public drivers::Thread::Body {
 public:
  void prepare(press::Press& press, press::Look& look, const ports::SystemClocks& clocks);
  void run() override;

  /// Supervisor. @return false if something runs already.
  bool start(press::Kind kind);
  bool start_look(std::size_t sensor);
  /// Something was asked for and is not finished yet; while it is, press, look and store belong to this thread.
  bool busy() const { return task_.load(std::memory_order_acquire) != Task::kNone; }
  /// Of the last press that was asked for.
  press::Kind kind() const { return kind_; }
  /// Presses and looks that were finished.
  uint32_t presses() const { return presses_.load(std::memory_order_acquire); }
  uint32_t looks() const { return looks_.load(std::memory_order_acquire); }

  ThreadLink link;

 private:
  enum class Task : uint8_t { kNone, kPress, kLook };
  bool ask(Task task);

  press::Press* press_ = nullptr;
  press::Look* look_ = nullptr;
  const ports::SystemClocks* clocks_ = nullptr;
  std::atomic<Task> task_{Task::kNone};
  press::Kind kind_ = press::Kind::kVerify;
  std::size_t sensor_ = 0;
  std::atomic<uint32_t> presses_{0}, looks_{0};
};

}  // namespace roomcal::board
