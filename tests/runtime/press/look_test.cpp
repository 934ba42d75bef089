#include "runtime/press/look.h"

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fakes/manual_clocks.h"

namespace roomcal::press {
namespace {

constexpr int kWidth = 320, kHeight = 240;

/// Hands out what it was given, once it was asked for a while ago.
struct ScriptedSweeps final : grab::SweepSource {
  void ask(std::size_t count) override { asked = count; }
  bool full() const override { return !given.empty(); }
  bool stop() override { return stops_refused-- <= 0; }
  std::span<const lidar::Sweep> sweeps() const override { return given; }
  uint32_t discarded() const override { return spoilt; }
  uint32_t discarded_flags() const override { return spoilt_flags; }

  std::vector<lidar::Sweep> given;
  std::size_t asked = 0;
  int stops_refused = 0;
  uint32_t spoilt = 0, spoilt_flags = 0;
};

/// One camera of 320 x 240 and one LiDAR.
class LookTest : public testing::Test {
 protected:
  LookTest() : ring_memory_(grab::ImageRing::bytes(kWidth, kHeight, 2)), block_(8 << 20) {
    arenas_ = std::move(Arenas::carve(block_, 0, 6 << 20)).value();
    calib::CameraSpec camera;
    camera.name = "cam0";
    camera.camera =
        camera::Camera::create({camera::Model::kPinholeRadtan, kWidth, kHeight, 300, 300, 160, 120, {}}).value();
    calib::LidarSpec lidar;
    lidar.name = "lidar0";
    EXPECT_TRUE(device_->cameras.push_back(camera));
    EXPECT_TRUE(device_->lidars.push_back(lidar));
    Arena ring_arena(ring_memory_);
    EXPECT_TRUE(ring_.create(kWidth, kHeight, 2, ring_arena).ok());
    EXPECT_TRUE(sources_.cameras.push_back({"cam0", &ring_}));
    EXPECT_TRUE(sources_.lidars.push_back({"lidar0", &sweeps_, 1}));
  }

  /// From now on the camera shows this.
  void show(const std::function<uint8_t(int x, int y)>& grey) {
    clocks_.on_sleep = [this, grey](int64_t now_ns) {
      const MutableImageView place = ring_.begin_write();
      if (place.empty()) return;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) place(x, y) = grey(x, y);
      ring_.publish({}, {now_ns, 1'000});
    };
  }
  const Sight& look(std::size_t sensor) {
    look_.run(sensor);
    return look_.sight();
  }
  std::string complaint() const { return std::string(look_.sight().complaint.view()); }

  fakes::ManualClocks clocks_;
  std::unique_ptr<calib::Device> device_ = std::make_unique<calib::Device>();
  calib::Limits limits_;
  std::vector<std::byte> ring_memory_, block_;
  Arenas arenas_;
  grab::ImageRing ring_;
  ScriptedSweeps sweeps_;
  grab::Sources sources_;
  Look look_{*device_, limits_, sources_, arenas_, clocks_};
};

std::vector<lidar::SweepPoint> half_turn() {
  std::vector<lidar::SweepPoint> points(1800);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].azimuth_rad = static_cast<float>(kPi * static_cast<double>(i) / static_cast<double>(points.size()));
    points[i].range_m = i == 7 ? 0.5F : i == 9 ? 6.0F : 2.0F;
    points[i].x_m = points[i].range_m * std::sin(points[i].azimuth_rad);
    points[i].y_m = points[i].range_m * std::cos(points[i].azimuth_rad);
  }
  return points;
}

TEST_F(LookTest, Camera_TellsLevels) {
  show([](int x, int) { return x < kWidth / 4 ? uint8_t{255} : uint8_t{40}; });
  const Sight& sight = look(0);
  EXPECT_TRUE(sight.came);
  EXPECT_TRUE(sight.camera);
  EXPECT_EQ(sight.sensor.view(), "cam0");
  EXPECT_EQ(sight.low, 40);
  EXPECT_EQ(sight.high, 255);
  EXPECT_NEAR(sight.saturated, 0.25, 0.01);
  EXPECT_EQ(sight.rings, 0U);
}

TEST_F(LookTest, DarkPicture_IsComplainedAboutWithItsLevels) {
  show([](int, int) { return uint8_t{3}; });
  const Sight& sight = look(0);
  EXPECT_TRUE(sight.came);
  EXPECT_EQ(sight.mean, 3);
  EXPECT_NE(complaint().find("cam0"), std::string::npos) << complaint();
}

TEST_F(LookTest, CameraThatDeliversNothing_IsNamedInTime) {
  const int64_t begin_ns = clocks_.now_ns();
  EXPECT_FALSE(look(0).came);
  EXPECT_NE(complaint().find("cam0: no image"), std::string::npos) << complaint();
  EXPECT_LT(clocks_.now_ns() - begin_ns, 1'600'000'000);
}

TEST_F(LookTest, Images_AreGivenBackAndSoIsTheMemory) {
  show([](int x, int y) { return static_cast<uint8_t>(60 + (x ^ y) % 120); });
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(look(0).came);
  EXPECT_EQ(arenas_.step.used(), 0U);
  EXPECT_EQ(ring_.hold_since(0).size(), 1U);
}

TEST_F(LookTest, Lidar_TellsItsHorizonAndRanges) {
  const std::vector<lidar::SweepPoint> points = half_turn();
  lidar::Sweep sweep;
  sweep.points = points;
  sweeps_.given = {sweep};
  sweeps_.stops_refused = 3;
  const Sight& sight = look(1);
  EXPECT_TRUE(sight.came);
  EXPECT_FALSE(sight.camera);
  EXPECT_EQ(sweeps_.asked, 1U);
  EXPECT_EQ(sight.points, points.size());
  EXPECT_NEAR(sight.horizon, 0.5, 0.03);
  EXPECT_EQ(sight.nearest_m, 0.5);
  EXPECT_EQ(sight.farthest_m, 6);
}

TEST_F(LookTest, LidarWithoutPackets_IsNamedInTime) {
  const int64_t begin_ns = clocks_.now_ns();
  EXPECT_FALSE(look(1).came);
  EXPECT_EQ(complaint(), "lidar0: no packets: check its power, cable and address");
  EXPECT_LT(clocks_.now_ns() - begin_ns, 2'100'000'000);
}

TEST_F(LookTest, SweepsThatWereAllSpoilt_AreToldApartFromNone) {
  sweeps_.spoilt = 4;
  sweeps_.spoilt_flags = lidar::kSweepLostPackets;
  const Sight& sight = look(1);
  EXPECT_FALSE(sight.came);
  EXPECT_EQ(sight.flags, lidar::kSweepLostPackets);
  EXPECT_EQ(complaint(), "lidar0: 4 sweeps came and none was whole: see `sensors` for losses");
}

TEST_F(LookTest, SensorThatIsNone_GivesAnEmptySight) {
  EXPECT_FALSE(look(2).came);
  EXPECT_TRUE(look_.sight().sensor.empty());
}

}  // namespace
}  // namespace roomcal::press
