#include "drivers/thermal/sysfs_thermometer.h"

#include <cerrno>
#include <cmath>

#include "tests/drivers/folder_of_test.h"
#include "tests/fakes/fake_file_kernel.h"

namespace roomcal::drivers {
namespace {

class SysfsThermometerTest : public test::FolderOfTest {
 protected:
  double reading_of(const std::string& content) {
    write("temp", content);
    return thermometer().read_c();
  }
  SysfsThermometer thermometer() { return {std::string_view((folder_ / "temp").c_str()), kernel_}; }

  fakes::FakeFileKernel kernel_;
};

TEST_F(SysfsThermometerTest, ThousandthsOfADegree_AreReadAtEveryCall) {
  EXPECT_DOUBLE_EQ(reading_of("41250\n"), 41.25);
  EXPECT_DOUBLE_EQ(reading_of("-7500\n"), -7.5);
  EXPECT_DOUBLE_EQ(reading_of("0"), 0);
  EXPECT_TRUE(thermometer().start().ok());
}

TEST_F(SysfsThermometerTest, WhatIsNoTemperature_IsUnknown) {
  for (const char* content :
       {"", "\n", "warm\n", "41.25\n", "41250 C\n", "-274000\n", "150001\n", "99999999999999999999\n"})
    EXPECT_TRUE(std::isnan(reading_of(content))) << content;
}

TEST_F(SysfsThermometerTest, FileThatIsMissing_IsNamedAndFoundLater) {
  EXPECT_TRUE(std::isnan(thermometer().read_c()));
  const Status started = thermometer().start();
  EXPECT_EQ(started.code(), StatusCode::kNotFound);
  EXPECT_NE(std::string(started.detail()).find("wiring.thermometer"), std::string::npos);
  EXPECT_DOUBLE_EQ(reading_of("20000\n"), 20);
}

// A sensor behind a bus answers EAGAIN or EIO at times.
TEST_F(SysfsThermometerTest, ReadingThatFails_IsUnknownAndTheNextOneCounts) {
  write("temp", "20000\n");
  SysfsThermometer thermometer = this->thermometer();
  kernel_.fail(fakes::FakeFileKernel::Call::kRead, 0, 1, EIO);
  EXPECT_TRUE(std::isnan(thermometer.read_c()));
  EXPECT_DOUBLE_EQ(thermometer.read_c(), 20);
}

TEST_F(SysfsThermometerTest, PathThatIsTooLong_IsRefused) {
  SysfsThermometer thermometer(std::string_view(std::string(200, 'a')), kernel_);
  EXPECT_EQ(thermometer.start().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace roomcal::drivers
