#include "tools/imu/samples.h"

#include <filesystem>
#include <string>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "tests/truth/random.h"
#include "tools/common/error.h"
#include "tools/common/files.h"

namespace roomcal::tools {
namespace {

const std::string kHeader = "stamp_ns,ax_mps2,ay_mps2,az_mps2,gx_radps\n";

class RestingImuFile : public testing::Test {
 protected:
  RestingImuFile() : file_(std::filesystem::path(testing::TempDir()) / "imu_samples_test.csv") {}
  ~RestingImuFile() override { std::filesystem::remove(file_); }
  RestingImu read(const std::string& text) const {
    write_atomic(file_, text);
    return read_resting_imu(file_);
  }
  /// @param ramp_mps2  by which x drifts from the first sample to the last.
  static std::string samples(int count, double ramp_mps2 = 0) {
    truth::Random random(1);
    std::string text = kHeader;
    for (int i = 0; i < count; ++i)
      text +=
          fmt::format("{},{:.6f},{:.6f},{:.6f},0.1\n", 1000 * i, 0.5 + ramp_mps2 * i / count + 0.02 * random.normal(),
                      0.02 * random.normal(), 9.8 + 0.02 * random.normal());
    return text;
  }

 private:
  std::filesystem::path file_;
};

TEST_F(RestingImuFile, AtRest_IsItsMeanAndHowWellThatIsKnown) {
  const RestingImu imu = read(samples(400));
  EXPECT_EQ(imu.samples, 400U);
  EXPECT_LT((imu.held_up_mps2 - Vec3(0.5, 0, 9.8)).cwiseAbs().maxCoeff(), 0.004);
  EXPECT_NEAR(imu.sigma_mps2.y(), 0.001, 0.0002);
}

TEST_F(RestingImuFile, WhatIsNoRestingImu_IsRefused) {
  EXPECT_THROW(read(samples(400, 0.2)), ToolError) << "moved";
  EXPECT_THROW(read(samples(9)), ToolError) << "too few";
  EXPECT_THROW(read("ax,ay,az\n1,2,3\n"), ToolError);
  EXPECT_THROW(read(kHeader + "1,2,3\n"), ToolError) << "a column is missing";
  EXPECT_THROW(read(samples(20) + "7,nan,0,0,0\n"), ToolError);
  EXPECT_THROW(read(samples(20) + "7,1.0x,0,0,0\n"), ToolError);
  EXPECT_THROW(read(""), ToolError);
  EXPECT_THROW(read_resting_imu("no/such.csv"), ToolError);
}

}  // namespace
}  // namespace roomcal::tools
