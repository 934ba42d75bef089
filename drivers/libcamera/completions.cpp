#include "drivers/libcamera/completions.h"

#include <algorithm>

namespace roomcal::drivers {

using Lock = std::lock_guard<std::mutex>;

void Completions::begin(LibraryCamera::Wake& wake) {
  const Lock lock(mutex_);
  wake_ = &wake;
  waiting_.clear();
  disconnected_ = false;
}

void Completions::end() {
  const Lock lock(mutex_);
  wake_ = nullptr;
  waiting_.clear();
}

bool Completions::take(Completion& completion) {
  const Lock lock(mutex_);
  if (waiting_.empty()) return false;
  completion = waiting_[0];
  std::copy(waiting_.begin() + 1, waiting_.end(), waiting_.begin());
  waiting_.pop_back();
  return true;
}

void Completions::clear() {
  const Lock lock(mutex_);
  waiting_.clear();
}

bool Completions::disconnected() const {
  const Lock lock(mutex_);
  return disconnected_;
}

void Completions::request_completed(libcamera::Request* request) {
  const Lock lock(mutex_);
  // There is room for every request; one that comes back twice is a bug of libcamera's and dropped.
  if (wake_ != nullptr && waiting_.push_back({request, clock_.now_ns()})) wake_->wake();
}

void Completions::camera_disconnected() {
  const Lock lock(mutex_);
  disconnected_ = true;
  if (wake_ != nullptr) wake_->wake();
}

}  // namespace roomcal::drivers
