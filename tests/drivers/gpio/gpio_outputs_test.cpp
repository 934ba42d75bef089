#include "drivers/gpio/gpio_indicator.h"
#include "drivers/gpio/gpio_trigger.h"
#include "tests/drivers/gpio/fake_gpio.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using fakes::FakeFileKernel;
using Call = FakeFileKernel::Call;
using test::FakeGpio;

class GpioOutputs : public testing::Test {
 protected:
  void SetUp() override { gpio_.add("/dev/gpiochip0", "soc", {"out"}); }
  FakeGpio::Line& line() { return gpio_.chips["/dev/gpiochip0"].lines[0]; }
  static GpioLineOptions options() {
    GpioLineOptions result;
    result.line = "out";
    return result;
  }

  FakeFileKernel kernel_;
  FakeGpio gpio_{kernel_};
  fakes::ManualClocks clocks_;
};

TEST_F(GpioOutputs, Indicator_IsDarkLitAndGivenBackDark) {
  GpioIndicator lamp(options(), kernel_);
  ASSERT_TRUE(lamp.start().ok());
  EXPECT_EQ(line().config.flags, uint64_t{GPIO_V2_LINE_FLAG_OUTPUT});
  lamp.set(true);
  EXPECT_TRUE(line().active);
  lamp.set(false);
  lamp.set(true);
  lamp.stop();
  EXPECT_EQ(line().written, (std::vector<bool>{true, false, true, false}));
  lamp.set(true);
  EXPECT_EQ(line().written.size(), 4U) << "it is no longer ours";
}

TEST_F(GpioOutputs, IndicatorThatFails_IsMadeUpFor) {
  GpioIndicator lamp(options(), kernel_);
  ASSERT_TRUE(lamp.start().ok());
  kernel_.fail(Call::kIoctl, 0, 1, EIO);
  lamp.set(true);
  EXPECT_FALSE(line().active);
  lamp.set(true);
  EXPECT_TRUE(line().active);
}

TEST_F(GpioOutputs, Trigger_IsOnePulseOfItsLength) {
  GpioTrigger trigger({options(), 2500}, kernel_, clocks_);
  ASSERT_TRUE(trigger.start().ok());
  EXPECT_STREQ(trigger.name(), "line");
  const int64_t before_ns = clocks_.now_ns();
  ASSERT_TRUE(trigger.fire().ok());
  EXPECT_EQ(clocks_.now_ns() - before_ns, 2'500'000);
  EXPECT_EQ(line().written, (std::vector<bool>{true, false}));
}

TEST_F(GpioOutputs, TriggerThatCannotBeSet_DidNotFire) {
  GpioTrigger trigger({options()}, kernel_, clocks_);
  ASSERT_TRUE(trigger.start().ok());
  kernel_.fail(Call::kIoctl, 0, 1, EIO);
  EXPECT_EQ(trigger.fire().code(), StatusCode::kUnavailable);
  EXPECT_TRUE(line().written.empty());
  EXPECT_TRUE(trigger.fire().ok());
}

TEST_F(GpioOutputs, TriggerThatSticks_HasFiredAndIsTakenBackFirst) {
  GpioTrigger trigger({options()}, kernel_, clocks_);
  ASSERT_TRUE(trigger.start().ok());
  kernel_.fail(Call::kIoctl, 1, 2, EIO);
  EXPECT_TRUE(trigger.fire().ok());
  EXPECT_TRUE(line().active);
  EXPECT_EQ(trigger.fire().code(), StatusCode::kUnavailable);
  EXPECT_TRUE(trigger.fire().ok());
  EXPECT_EQ(line().written, (std::vector<bool>{true, false, true, false}));
}

TEST_F(GpioOutputs, NotStarted_IsNoHarm) {
  GpioTrigger trigger({options()}, kernel_, clocks_);
  EXPECT_EQ(trigger.fire().code(), StatusCode::kUnavailable);
  GpioIndicator lamp(options(), kernel_);
  lamp.set(true);
  lamp.stop();
  EXPECT_TRUE(line().written.empty());
}

TEST_F(GpioOutputs, ChipThatRefuses_IsNamed) {
  GpioIndicator lamp(options(), kernel_);
  kernel_.fail(Call::kIoctl, 2, 1, EINVAL);  // chip's information, line's, request
  EXPECT_EQ(lamp.start().code(), StatusCode::kUnavailable);
  EXPECT_TRUE(lamp.start().ok());
}

}  // namespace
}  // namespace roomcal::drivers
