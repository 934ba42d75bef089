#include "board/common/press_thread.h"

namespace roomcal::board {

namespace {

constexpr int64_t kIdle_ns = 5'000'000;

}  // namespace

void PressThread::prepare(press::Press& press, press::Look& look, const ports::SystemClocks& clocks) {
  press_ = &press;
  look_ = &look;
  clocks_ = &clocks;
}

void PressThread::run() {
  while (!link.stop.load(std::memory_order_acquire)) {
    link.beat(clocks_->now_ns());
    const Task task = task_.load(std::memory_order_acquire);
    if (task == Task::kPress) {
      press_->run(kind_);
      presses_.fetch_add(1, std::memory_order_release);
    } else if (task == Task::kLook) {
      look_->run(sensor_);
      looks_.fetch_add(1, std::memory_order_release);
    } else {
      clocks_->sleep_until(clocks_->now_ns() + kIdle_ns);
      continue;
    }
    task_.store(Task::kNone, std::memory_order_release);
  }
}

bool PressThread::ask(Task task) {
  if (busy()) return false;
  task_.store(task, std::memory_order_release);
  return true;
}

bool PressThread::start(press::Kind kind) {
  if (busy()) return false;
  kind_ = kind;
  press_->begin();
  return ask(Task::kPress);
}

bool PressThread::start_look(std::size_t sensor) {
  if (busy()) return false;
  sensor_ = sensor;
  return ask(Task::kLook);
}

}  // namespace roomcal::board
