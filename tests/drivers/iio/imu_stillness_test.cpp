#include "drivers/iio/imu_stillness.h"

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/drivers/folder_of_test.h"
#include "tests/fakes/fake_file_kernel.h"

namespace roomcal::drivers {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kMs = 1'000'000;

/// A folder as an IIO device shows it: gyroscope with a bias, accelerometer that feels gravity.
class ImuStillnessTest : public test::FolderOfTest {
 protected:
  ImuStillnessTest() {
    write_number("in_anglvel_scale", 0.001);
    write_number("in_accel_scale", 0.01);
    set_readings(0);
  }

  void write_number(const std::string& file, double value) { write(file, std::to_string(value) + "\n"); }
  void set_readings(int noise, double rate_radps = 0, double push_mps2 = 0) {
    write_number("in_anglvel_x_raw", 30 + noise + std::round(rate_radps / 0.001));
    write_number("in_anglvel_y_raw", -12);
    write_number("in_anglvel_z_raw", 5 - noise);
    write_number("in_accel_x_raw", std::round(push_mps2 / 0.01));
    write_number("in_accel_y_raw", noise);
    write_number("in_accel_z_raw", 981);
  }
  /// Half a second of quiet readings.
  void rest() {
    for (int i = 0; i < 25; ++i) {
      set_readings(i % 3);
      step();
    }
  }
  void step() {
    now_ns_ += 20 * kMs;
    imu_.sample(now_ns_);
  }
  std::string why() { return std::string(imu_.look(now_ns_).why.view()); }

  fakes::FakeFileKernel kernel_;
  int64_t now_ns_ = 1'000 * kMs;
  ImuStillness imu_{{.folder = std::string_view(folder_.string())}, kernel_};
};

TEST_F(ImuStillnessTest, DeviceAtRest_IsStillWhateverTheBias) {
  ASSERT_TRUE(imu_.start().ok());
  rest();
  EXPECT_TRUE(imu_.look(now_ns_).still) << why();
  EXPECT_NEAR(imu_.mean_acceleration_mps2()[2], 9.81, 1e-9);
}

TEST_F(ImuStillnessTest, WindowNotFull_IsMotion) {
  ASSERT_TRUE(imu_.start().ok());
  for (int i = 0; i < 5; ++i) {
    set_readings(i % 3);
    step();
    EXPECT_FALSE(imu_.look(now_ns_).still);
  }
  EXPECT_NE(why().find("long enough"), std::string::npos);
}

TEST_F(ImuStillnessTest, Turning_IsMotionUntilTheWindowIsQuietAgain) {
  ASSERT_TRUE(imu_.start().ok());
  rest();
  set_readings(0, 0.05);
  step();
  EXPECT_NE(why().find("turns"), std::string::npos);
  for (int i = 0; i < 14; ++i) {
    set_readings(i % 3);
    step();
    EXPECT_FALSE(imu_.look(now_ns_).still) << i;
  }
  rest();
  EXPECT_TRUE(imu_.look(now_ns_).still) << why();
}

TEST_F(ImuStillnessTest, Shaking_IsMotion) {
  ASSERT_TRUE(imu_.start().ok());
  rest();
  set_readings(0, 0, 1.5);
  step();
  EXPECT_NE(why().find("shakes"), std::string::npos);
}

TEST_F(ImuStillnessTest, FrozenSensor_IsNotBelieved) {
  ASSERT_TRUE(imu_.start().ok());
  set_readings(0);
  for (int i = 0; i < 30; ++i) step();
  EXPECT_NE(why().find("never change"), std::string::npos);
}

TEST_F(ImuStillnessTest, ReadingThatFails_IsDoubtAndIsLookedForAgain) {
  ASSERT_TRUE(imu_.start().ok());
  rest();
  fs::rename(folder_ / "in_accel_y_raw", folder_ / "away");
  step();
  EXPECT_FALSE(imu_.look(now_ns_).still);
  EXPECT_EQ(imu_.failed_readings(), 1U);
  fs::rename(folder_ / "away", folder_ / "in_accel_y_raw");
  for (int i = 0; i < 60; ++i) step();
  rest();
  EXPECT_TRUE(imu_.look(now_ns_).still) << why();
}

TEST_F(ImuStillnessTest, NoReadingLately_IsDoubt) {
  ASSERT_TRUE(imu_.start().ok());
  rest();
  now_ns_ += 150 * kMs;
  EXPECT_NE(why().find("lately"), std::string::npos);
}

TEST_F(ImuStillnessTest, NoSuchDevice_IsNamed) {
  fs::remove(folder_ / "in_anglvel_scale");
  EXPECT_EQ(imu_.start().code(), StatusCode::kNotFound);
  step();
  EXPECT_NE(why().find("cannot be read"), std::string::npos);
}

TEST_F(ImuStillnessTest, EveryReadThatFails_IsNeverStill) {
  ASSERT_TRUE(imu_.start().ok());
  for (int at = 0; at < 8; ++at) {
    rest();
    rest();
    ASSERT_TRUE(imu_.look(now_ns_).still) << at << why();
    kernel_.fail(fakes::FakeFileKernel::Call::kRead, at % 6, 1, EIO);
    step();
    EXPECT_FALSE(imu_.look(now_ns_).still) << at;
    kernel_.heal();
    for (int i = 0; i < 60; ++i) step();
  }
}

}  // namespace
}  // namespace roomcal::drivers
