#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "runtime/calib/memory_plan.h"
#include "runtime/calib/session.h"
#include "tools/common/image_io.h"
#include "tools/common/steady_clock.h"

namespace roomcal::flow {

/// A session as a board arms it: one block of memory from the plan, the index built, the permanent part sealed.
class ArmedSession {
 public:
  ArmedSession(const calib::Device& device, const map::RoomMap& map)
      : plan_(calib::plan_memory(device, map)),
        block_(plan_.total_bytes()),
        arenas_(std::move(Arenas::carve(block_, plan_.permanent_bytes, plan_.scratch_bytes)).value()),
        index_(map::TriangleIndex::build(map, arenas_.permanent).value()),
        session_{device, map, index_, {}},
        outcome_(std::make_unique<calib::Outcome>()) {
    arenas_.permanent.seal();
  }

  /// One shot; what it left in the step arena is given back before the next one, so read the outcome first.
  Status calibrate(std::span<const ImageView> images) {
    arenas_.step = Arena(std::span(block_).subspan(plan_.permanent_bytes, plan_.step_bytes));
    return calib::calibrate(session_, calib::Shot{images, {}}, clock_, arenas_, *outcome_);
  }

  const calib::Outcome& outcome() const { return *outcome_; }
  const Arenas& arenas() const { return arenas_; }

 private:
  calib::MemoryPlan plan_;
  std::vector<std::byte> block_;
  Arenas arenas_;
  map::TriangleIndex index_;
  calib::Session session_;
  tools::SteadyClock clock_;
  std::unique_ptr<calib::Outcome> outcome_;
};

inline std::vector<ImageView> views(std::span<const cv::Mat> images) {
  std::vector<ImageView> out;
  std::transform(images.begin(), images.end(), std::back_inserter(out), tools::view);
  return out;
}

}  // namespace roomcal::flow
