#pragma once

#include <array>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <vector>

#include "drivers/os/linux_clocks.h"
#include "drivers/relay/library_camera.h"

namespace roomcal::drivers {

/// What a test tells a camera to do, and sees of it. Outlives the camera. Any thread.
class Script {
  friend class ScriptedCamera;
  template <typename Edit>
  void edit(const Edit& change) {
    const std::lock_guard lock(mutex_);
    change();
  }
  template <typename Look>
  auto look(const Look& value) {
    const std::lock_guard lock(mutex_);
    return value();
  }

 public:
  static constexpr int kWidth = 4, kHeight = 3, kSlots = 4;

  bool free_running = true;

  // The test's side.
  /// The n-th open() ends so; later ones well.
  void on_open(std::initializer_list<LibraryResult> results) {
    edit([&] { opens_ = results; });
  }
  void on_restart(std::initializer_list<LibraryResult> results) {
    edit([&] { restarts_ = results; });
  }
  void on_diagnose(ports::ImageFault fault) {
    edit([&] { diagnosis_ = fault; });
  }
  void on_look_after(ports::ImageFault fault) {
    edit([&] { found_ = fault; });
  }
  void on_fire(bool done) {
    edit([&] { fires_ = done; });
  }
  /// The library does not return from its next calls until release().
  void hang_in(const char* call) {
    edit([&] { hangs_in_ = call; });
  }
  void release() {
    edit([&] { hangs_in_ = ""; });
    go_on_.notify_all();
  }
  /// An image of one grey, into the next free slot. @return false if no slot is free.
  bool image(uint32_t number, uint8_t grey, ports::ImageFault fault = ports::ImageFault::kCount);
  bool image_stamped(uint32_t number, Stamp exposed);

  int opened() {
    return look([&] { return opened_; });
  }
  int restarted() {
    return look([&] { return restarted_; });
  }
  int closed() {
    return look([&] { return closed_; });
  }
  int fired() {
    return look([&] { return fired_; });
  }
  std::size_t slots_with_library() {
    return look([&] { return free_.size(); });
  }

 private:
  bool finish(uint32_t number, uint8_t grey, ports::ImageFault fault, Stamp exposed);

  std::mutex mutex_;
  std::condition_variable go_on_;
  std::deque<LibraryResult> opens_, restarts_;
  ports::ImageFault diagnosis_ = ports::ImageFault::kStall, found_ = ports::ImageFault::kCount;
  bool fires_ = true;
  std::string_view hangs_in_;
  LibraryCamera::Wake* wake_ = nullptr;  // null: closed
  std::array<std::array<std::byte, kWidth * kHeight>, kSlots> pixels_{};
  std::deque<int> free_;
  std::deque<LibraryImage> finished_;
  int opened_ = 0, restarted_ = 0, closed_ = 0, fired_ = 0;
};

/// A library's camera that does what a script says.
class ScriptedCamera final : public LibraryCamera {
 public:
  explicit ScriptedCamera(Script& script) : script_(script) {}

  const char* library() const override { return "Script"; }
  Status reserve() override { return ok_status(); }
  LibraryResult open(Wake& wake) override;
  LibraryResult restart() override;
  void close() override;
  bool poll(LibraryImage& image) override;
  void give_back(int slot) override {
    script_.edit([&] { script_.free_.push_back(slot); });
  }
  ports::ImageFault diagnose() override {
    return script_.look([&] { return script_.diagnosis_; });
  }
  ports::ImageFault look_after(int64_t) override {
    return script_.look([&] { return std::exchange(script_.found_, ports::ImageFault::kCount); });
  }
  bool free_running() const override { return script_.free_running; }
  bool fire() override {
    return script_.look([&] { return ++script_.fired_, script_.fires_; });
  }

 private:
  void may_hang(const char* call);

  Script& script_;
};

inline bool Script::finish(uint32_t number, uint8_t grey, ports::ImageFault fault, Stamp exposed) {
  const std::lock_guard lock(mutex_);
  if (free_.empty() || wake_ == nullptr) return false;
  const int slot = free_.front();
  free_.pop_front();
  auto& pixels = pixels_[static_cast<std::size_t>(slot)];
  pixels.fill(static_cast<std::byte>(grey));
  LibraryImage image;
  image.slot = slot;
  image.fault = fault;
  image.raw = {PixelFormat::kGrey8, kWidth, kHeight, 0, pixels};
  image.number = number;
  image.exposed = exposed;
  image.arrived_ns = LinuxClocks().now_ns();
  finished_.push_back(image);
  return true;
}

inline bool Script::image(uint32_t number, uint8_t grey, ports::ImageFault fault) {
  const bool done = finish(number, grey, fault, {LinuxClocks().now_ns(), ClockId::kMonotonic});
  LibraryCamera::Wake* wake = look([&] { return wake_; });
  if (wake != nullptr) wake->wake();
  return done;
}

inline bool Script::image_stamped(uint32_t number, Stamp exposed) {
  const bool done = finish(number, 0, ports::ImageFault::kCount, exposed);
  LibraryCamera::Wake* wake = look([&] { return wake_; });
  if (wake != nullptr) wake->wake();
  return done;
}

inline void ScriptedCamera::may_hang(const char* call) {
  std::unique_lock lock(script_.mutex_);
  script_.go_on_.wait(lock, [&] { return script_.hangs_in_ != call; });
}

inline LibraryResult ScriptedCamera::open(Wake& wake) {
  may_hang("open");
  const std::lock_guard lock(script_.mutex_);
  ++script_.opened_;
  LibraryResult result;
  if (!script_.opens_.empty()) {
    result = script_.opens_.front();
    script_.opens_.pop_front();
  }
  if (!result.ok()) return result;
  script_.wake_ = &wake;
  script_.free_.clear();
  for (int i = 0; i < Script::kSlots; ++i) script_.free_.push_back(i);
  script_.finished_.clear();
  return result;
}

inline LibraryResult ScriptedCamera::restart() {
  const std::lock_guard lock(script_.mutex_);
  ++script_.restarted_;
  LibraryResult result;
  if (!script_.restarts_.empty()) {
    result = script_.restarts_.front();
    script_.restarts_.pop_front();
  }
  return result;
}

inline void ScriptedCamera::close() {
  may_hang("close");
  const std::lock_guard lock(script_.mutex_);
  ++script_.closed_;
  script_.wake_ = nullptr;
}

inline bool ScriptedCamera::poll(LibraryImage& image) {
  const std::lock_guard lock(script_.mutex_);
  if (script_.finished_.empty()) return false;
  image = script_.finished_.front();
  script_.finished_.pop_front();
  return true;
}

}  // namespace roomcal::drivers
