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

}  // namespace
}  // namespace roomcal::calib
