// What a machine tells about itself.
#include "board/common/machine.h"

namespace roomcal::board {

namespace {

face::ArenaVitals vitals_of(std::string_view name, const Arena& arena) {
  return {name, arena.capacity(), arena.used(), arena.peak(), arena.refusals()};
}

face::ThreadVitals vitals_of(std::string_view name, const ThreadLink& link, const drivers::Thread& thread) {
  face::ThreadVitals vitals;
  vitals.name = name;
  vitals.answered_ns = link.pulse.last_ns();
  vitals.stack_bytes = thread.stack_bytes();
  vitals.stack_peak = thread.stack_peak();
  vitals.minor_faults = link.minor_faults.load(std::memory_order_relaxed);
  vitals.major_faults = link.major_faults.load(std::memory_order_relaxed);
  return vitals;
}

}  // namespace

void Machine::examine(face::Vitals& vitals) {
  vitals.armed_ns = armed_ns_;
  vitals.locked_bytes = memory_.bytes().size();
  vitals.locked = memory_.lock_status().ok();
  static_cast<void>(vitals.arenas.push_back(vitals_of("board", arena_)));
  if (arenas_) {
    static_cast<void>(vitals.arenas.push_back(vitals_of("permanent", arenas_->permanent)));
    static_cast<void>(vitals.arenas.push_back(vitals_of("step", arenas_->step)));
    static_cast<void>(vitals.arenas.push_back(vitals_of("scratch", arenas_->scratch)));
  }
  if (!armed_) return;
  vitals.trigger = synchronization_;
  vitals.trigger_trouble = trigger_trouble_;
  for (std::size_t i = 0; i < device_.cameras.size(); ++i) {
    static_cast<void>(vitals.cameras.push_back(camera_threads_[i].vitals()));
    static_cast<void>(
        vitals.threads.push_back(vitals_of(device_.cameras[i].name.view(), camera_threads_[i].link, threads_[i])));
  }
  for (std::size_t i = 0; i < lidar_thread_.size(); ++i)
    static_cast<void>(vitals.lidars.push_back(lidar_thread_.vitals(i)));
  if (!device_.lidars.empty())
    static_cast<void>(
        vitals.threads.push_back(vitals_of("lidars", lidar_thread_.link, threads_[calib::kMaxCameras + 1])));
  static_cast<void>(vitals.threads.push_back(vitals_of("session", press_thread_.link, threads_[calib::kMaxCameras])));
}

}  // namespace roomcal::board
