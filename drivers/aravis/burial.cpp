#include "drivers/aravis/burial.h"

#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

namespace roomcal::drivers {

void AravisShared::wake() {
  const std::lock_guard lock(mutex_);
  if (listener_ != nullptr) listener_->wake();
}

void AravisShared::listen(LibraryCamera::Wake* listener) {
  const std::lock_guard lock(mutex_);
  listener_ = listener;
}

void AravisShared::lose_control() {
  control_lost_ = true;
  wake();
}

bool Burial::wait(int64_t wait_ns) const {
  constexpr int64_t kStepNs = 10'000'000;
  for (int64_t waited_ns = 0; *connections_ > 0 && waited_ns < wait_ns; waited_ns += kStepNs)
    std::this_thread::sleep_for(std::chrono::nanoseconds(kStepNs));
  return *connections_ == 0;
}

void Burial::bury(AravisConnection connection) {
  ++*connections_;
  auto rites = [count = connections_, dead = std::make_shared<AravisConnection>(std::move(connection))] {
    dead->stream.reset();
    dead->camera.reset();
    --*count;
  };
  try {
    std::thread(rites).detach();
  } catch (const std::system_error&) {
    rites();  // no thread to be had: it takes its time here
  }
}

}  // namespace roomcal::drivers
