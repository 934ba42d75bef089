#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "runtime/calib/memory_plan.h"
#include "runtime/grab/clock_map.h"
#include "runtime/press/press.h"
#include "tests/fakes/manual_clocks.h"
#include "tests/fakes/power_cut_medium.h"
#include "tools/map/map_builder.h"

namespace roomcal::press::test {

/// Two cameras in a simulated room: what they are, see and know of it.
struct SeenRoom {
  tools::LoadedMap map;
  calib::Device device;  ///< true intrinsics, no nominal mounting
  std::vector<cv::Mat> images;
};
/// Rendered once for the whole program.
const SeenRoom& seen_room();

/// A device as a board arms it, its store on an emulated medium, its clocks wound by whoever waits. The cameras run
/// free and show `images`.
class PressBench {
 public:
  /// @param max_spread_ns  as of grab::GrabOptions. @param thermometer  null: there is none.
  explicit PressBench(int64_t max_spread_ns = 0, ports::Thermometer* thermometer = nullptr);

  /// As the board does it. @return the reasons, one line each.
  std::string press(Kind kind);
  const Report& report() const { return press_->report(); }
  std::string reasons() const;

  fakes::ManualClocks clocks;
  std::vector<cv::Mat> images;      ///< empty: this camera delivers nothing
  std::function<void()> on_images;  ///< called before each set of images
  ClockId stamps = ClockId::kMonotonic;
  fakes::PowerCutMedium medium;
  store::Store store;

  Press& session() { return *press_; }

 private:
  void deliver(int64_t now_ns);
  void publish(std::size_t camera);

  calib::MemoryPlan plan_;
  std::vector<std::byte> block_, ring_memory_, store_memory_;
  Arenas arenas_;
  map::TriangleIndex index_;
  Arena store_arena_, ring_arena_;
  std::array<grab::ImageRing, 2> rings_;
  std::array<grab::ClockMap, 2> clock_maps_;
  grab::Sources sources_;
  std::unique_ptr<calib::Session> session_;
  std::unique_ptr<grab::Grabber> grabber_;
  std::unique_ptr<Press> press_;
  int64_t next_image_ns_ = 0;
};

}  // namespace roomcal::press::test
