#include "drivers/gpio/gpio_chip.h"

#include "tests/drivers/gpio/fake_gpio.h"

namespace roomcal::drivers {
namespace {

class GpioChipTest : public testing::Test {
 protected:
  void SetUp() override {
    gpio_.add("/dev/gpiochip0", "expander", {"", "led", "7"});
    gpio_.add("/dev/gpiochip3", "soc", {"a", "b", "", "", "btn-calibrate", "trigger", "", "named"});
  }
  Status find(const char* line, const char* chip) {
    GpioLineOptions options;
    options.line = line;
    options.chip = chip;
    place_.offset = 99;
    return find_gpio_line(options, kernel_, place_);
  }

  fakes::FakeFileKernel kernel_;
  test::FakeGpio gpio_{kernel_};
  GpioPlace place_;
};

TEST_F(GpioChipTest, Name_IsFoundOnWhateverChip) {
  ASSERT_TRUE(find("btn-calibrate", "").ok());
  EXPECT_EQ(place_.offset, 4U);
  ASSERT_TRUE(find("led", "").ok());
  EXPECT_EQ(place_.offset, 1U);
}

TEST_F(GpioChipTest, ChipByPathOrLabel_OnlyThere) {
  ASSERT_TRUE(find("trigger", "/dev/gpiochip3").ok());
  ASSERT_TRUE(find("trigger", "soc").ok());
  EXPECT_EQ(place_.offset, 5U);
  EXPECT_EQ(find("trigger", "expander").code(), StatusCode::kNotFound);
  EXPECT_EQ(find("trigger", "/dev/gpiochip0").code(), StatusCode::kNotFound);
  EXPECT_EQ(find("trigger", "/dev/gpiochip9").code(), StatusCode::kNotFound);
}

TEST_F(GpioChipTest, Number_NeedsItsChipAndGivesWayToAName) {
  EXPECT_EQ(find("7", "").code(), StatusCode::kInvalidArgument);
  ASSERT_TRUE(find("7", "soc").ok());
  EXPECT_EQ(place_.offset, 7U);
  ASSERT_TRUE(find("7", "expander").ok());
  EXPECT_EQ(place_.offset, 2U) << "the line called 7";
  EXPECT_EQ(find("8", "soc").code(), StatusCode::kNotFound);
  EXPECT_EQ(find("-1", "soc").code(), StatusCode::kNotFound);
  EXPECT_EQ(find("99999999999999", "soc").code(), StatusCode::kNotFound);
}

TEST_F(GpioChipTest, NoName_IsRefused) {
  EXPECT_EQ(find("", "soc").code(), StatusCode::kInvalidArgument) << "lines without a name are many";
  EXPECT_EQ(find("nowhere", "").code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace roomcal::drivers
