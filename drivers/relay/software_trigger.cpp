#include "drivers/relay/software_trigger.h"

#include <algorithm>

namespace roomcal::drivers {

namespace {
constexpr int64_t kTellNs = 1'000'000'000;
}

Status SoftwareTrigger::add(RelaySource& camera) {
  if (!cameras_.push_back(&camera)) return {StatusCode::kCapacity, "more cameras than a software trigger serves"};
  return ok_status();
}

Status SoftwareTrigger::fire() {
  const auto streams = [](RelaySource* camera) { return camera->streams(); };
  if (cameras_.empty() || !std::all_of(cameras_.begin(), cameras_.end(), streams))
    return {StatusCode::kUnavailable, "a camera of the software trigger does not stream; see its log"};
  bool told = true;
  for (RelaySource* camera : cameras_) told = camera->want_fire() && told;
  const int64_t deadline_ns = clocks_.now_ns() + kTellNs;
  for (RelaySource* camera : cameras_) told = camera->fired(deadline_ns) && told;
  if (told) return ok_status();
  return {StatusCode::kUnavailable, "a camera could not be told to expose; check its trigger mode and cable"};
}

}  // namespace roomcal::drivers
