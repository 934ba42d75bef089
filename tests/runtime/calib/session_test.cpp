#include "runtime/calib/session.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::calib {
namespace {

class CountingClock final : public ports::Clock {
 public:
  int64_t now_ns() const override { return ++calls_; }

 private:
  mutable int64_t calls_ = 0;
};

TEST(Session, NumberOfImagesUnlikeTheDevice_IsAnErrorAndNeverAPass) {
  const auto device = std::make_unique<Device>();
  CameraSpec spec;
  spec.name = "cam0";
  ASSERT_TRUE(device->cameras.push_back(spec));
  const map::RoomMap map;
  const map::TriangleIndex index;
  Arenas arenas;
  const auto outcome = std::make_unique<Outcome>();
  outcome->verdict = Verdict::kPass;
  EXPECT_EQ(calibrate({*device, map, index, {}}, Shot(), CountingClock(), arenas, *outcome).code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(outcome->verdict, Verdict::kFailService);
}

TEST(Session, NoImageAtAll_FailsWithOneReasonACamera) {
  const auto device = std::make_unique<Device>();
  for (const char* name : {"cam0", "cam1"}) {
    CameraSpec spec;
    spec.name = name;
    ASSERT_TRUE(device->cameras.push_back(spec));
  }
  const map::RoomMap map;
  const map::TriangleIndex index;
  std::vector<std::byte> block(1 << 16);
  Arenas arenas = std::move(Arenas::carve(block, 0, 1 << 12)).value();
  const std::vector<ImageView> images(2);
  const auto outcome = std::make_unique<Outcome>();
  // The map is empty, so the step arena is asked for nothing: a shot without images must not even get there.
  const Status status = calibrate({*device, map, index, {}}, Shot{images, {}}, CountingClock(), arenas, *outcome);
  ASSERT_TRUE(status.ok()) << status.detail();
  EXPECT_EQ(outcome->verdict, Verdict::kFailRetry);
  ASSERT_EQ(outcome->reasons.size(), 2u);
  EXPECT_EQ(std::string(outcome->reasons[1].view()).rfind("cam1: no image", 0), 0u);
  for (const CameraOutcome& camera : outcome->cameras) EXPECT_FALSE(camera.located || camera.in_rig);
}

/// Lets a number of steps pass and stops the next; keeps what it was told.
class StoppingObserver final : public Observer {
 public:
  explicit StoppingObserver(std::size_t steps) : allowed_(steps) {}
  bool on_step(const Progress& progress) override {
    told_.push_back(std::string(to_string(progress.stage)) + "/" + std::string(progress.sensor));
    EXPECT_EQ(progress.done, told_.size() - 1);
    EXPECT_EQ(progress.total, 6U);
    return told_.size() <= allowed_;
  }
  const std::vector<std::string>& told() const { return told_; }

 private:
  std::size_t allowed_;
  std::vector<std::string> told_;
};

TEST(Session, Observed_TellsEveryStepOnceAndStopsBeforeAnyOfThem) {
  const auto device = std::make_unique<Device>();
  for (const char* name : {"cam0", "cam1"}) {
    CameraSpec spec;
    spec.name = name;
    ASSERT_TRUE(device->cameras.push_back(spec));
  }
  const map::RoomMap map;
  const map::TriangleIndex index;
  std::vector<std::byte> block(1 << 16);
  const std::vector<ImageView> images(2);
  const auto outcome = std::make_unique<Outcome>();
  const std::vector<std::string> all = {"detect/cam0", "detect/cam1", "locate/cam0",
                                        "locate/cam1", "refine/",     "judge/"};
  for (std::size_t steps = 0; steps <= all.size(); ++steps) {
    Arenas arenas = std::move(Arenas::carve(block, 0, 1 << 12)).value();
    StoppingObserver observer(steps);
    const Status status =
        calibrate({*device, map, index, {}}, Shot{images, {}}, CountingClock(), arenas, *outcome, &observer);
    const bool stopped = steps < all.size();
    EXPECT_EQ(status.code(), stopped ? StatusCode::kCancelled : StatusCode::kOk);
    EXPECT_EQ(
        observer.told(),
        std::vector<std::string>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(stopped ? steps + 1 : steps)));
    EXPECT_EQ(outcome->verdict, Verdict::kFailRetry);
    EXPECT_EQ(outcome->reasons.size(), stopped ? 1U : 2U);
  }
}

}  // namespace
}  // namespace roomcal::calib
