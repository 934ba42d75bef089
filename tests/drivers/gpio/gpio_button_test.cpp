#include "drivers/gpio/gpio_button.h"

#include "tests/drivers/gpio/fake_gpio.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using fakes::FakeFileKernel;
using Call = FakeFileKernel::Call;
using test::FakeGpio;

constexpr int64_t kSecond_ns = 1'000'000'000;

GpioButtonOptions options() {
  GpioButtonOptions result;
  result.line.line = "btn-calibrate";
  result.line.active_low = true;
  result.line.bias = GpioBias::kPullUp;
  result.debounce_us = 5000;
  return result;
}

class GpioButtonTest : public testing::Test {
 protected:
  void SetUp() override { gpio_.add("/dev/gpiochip0", "soc", {"", "btn-calibrate"}); }
  FakeGpio::Line& line() { return gpio_.chips["/dev/gpiochip0"].lines[1]; }
  std::string told() {
    std::string text;
    for (ports::ButtonEdge edge; button_.next(edge);)
      text += (edge.down ? "down " : "up ") + std::to_string(edge.stamp_ns / 1'000'000) + " ";
    return text;
  }

  FakeFileKernel kernel_;
  FakeGpio gpio_{kernel_};
  fakes::ManualClocks clocks_;
  GpioButton button_{options(), kernel_, clocks_};
};

TEST_F(GpioButtonTest, Requested_AsTheProfileSays) {
  ASSERT_TRUE(button_.start().ok());
  const gpio_v2_line_config& config = line().config;
  EXPECT_EQ(config.flags, uint64_t{GPIO_V2_LINE_FLAG_INPUT} | GPIO_V2_LINE_FLAG_EDGE_RISING |
                              GPIO_V2_LINE_FLAG_EDGE_FALLING | GPIO_V2_LINE_FLAG_ACTIVE_LOW |
                              GPIO_V2_LINE_FLAG_BIAS_PULL_UP)
      << "no clock flag: the monotonic one";
  ASSERT_EQ(config.num_attrs, 1U);
  EXPECT_EQ(config.attrs[0].attr.id, GPIO_V2_LINE_ATTR_ID_DEBOUNCE);
  EXPECT_EQ(config.attrs[0].attr.debounce_period_us, 5000U);
  EXPECT_EQ(config.attrs[0].mask, 1U);
}

TEST_F(GpioButtonTest, Press_ComesWithItsStamps) {
  ASSERT_TRUE(button_.start().ok());
  FakeGpio::change(line(), true, 5 * kSecond_ns);
  FakeGpio::change(line(), false, 8 * kSecond_ns);
  EXPECT_EQ(told(), "down 5000 up 8000 ");
  EXPECT_EQ(told(), "");
}

TEST_F(GpioButtonTest, HeldAtTheStart_NoEdgeUntilReleased) {
  line().active = true;
  ASSERT_TRUE(button_.start().ok());
  FakeGpio::change(line(), false, kSecond_ns);
  FakeGpio::change(line(), true, 2 * kSecond_ns);
  EXPECT_EQ(told(), "down 2000 ");
}

TEST_F(GpioButtonTest, KernelDroppedTheOldestEdges_TheLastOnesTell) {
  ASSERT_TRUE(button_.start().ok());
  FakeGpio::change(line(), true, kSecond_ns);
  EXPECT_EQ(told(), "down 1000 ");
  line().edges += 1;  // a release that fell out of the queue
  FakeGpio::change(line(), true, 3 * kSecond_ns);
  EXPECT_EQ(told(), "") << "still down, as far as it matters";
  FakeGpio::change(line(), false, 4 * kSecond_ns);
  EXPECT_EQ(told(), "up 4000 ");
}

TEST_F(GpioButtonTest, ChipThatVanishes_ComesBackWithItsState) {
  ASSERT_TRUE(button_.start().ok());
  FakeGpio::change(line(), true, kSecond_ns);
  EXPECT_EQ(told(), "down 1000 ");
  FakeGpio::unplug(line());
  EXPECT_EQ(told(), "");
  EXPECT_EQ(button_.fd(), -1);
  line().active = false;
  clocks_.advance(kSecond_ns);
  EXPECT_EQ(told(), "up " + std::to_string(clocks_.now_ns() / 1'000'000) + " ");
  FakeGpio::change(line(), true, 9 * kSecond_ns);
  EXPECT_EQ(told(), "down 9000 ");
}

TEST_F(GpioButtonTest, EveryCallFailingOnce_TheNextPressIsToldAllTheSame) {
  for (const Call call : {Call::kOpen, Call::kRead, Call::kIoctl}) {
    for (int at = 0;; ++at) {
      FakeFileKernel kernel;
      FakeGpio gpio(kernel);
      gpio.add("/dev/gpiochip0", "soc", {"", "btn-calibrate"});
      fakes::ManualClocks clocks;
      GpioButton button(options(), kernel, clocks);
      kernel.fail(call, at, 1, EIO);
      static_cast<void>(button.start().ok());
      ports::ButtonEdge edge;
      static_cast<void>(button.next(edge));
      clocks.advance(2 * kSecond_ns);
      static_cast<void>(button.next(edge));
      const bool fault_came = kernel.count(call) > at;
      FakeGpio::change(gpio.chips["/dev/gpiochip0"].lines[1], true, 5 * kSecond_ns);
      bool told = button.next(edge);
      clocks.advance(2 * kSecond_ns);
      told = told || button.next(edge);
      ASSERT_TRUE(told) << "call " << static_cast<int>(call) << " number " << at;
      if (!fault_came) break;
    }
  }
}

TEST_F(GpioButtonTest, LineOfSomebodyElse_IsNamed) {
  line().busy = true;
  const Status started = button_.start();
  EXPECT_EQ(started.code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(started.detail()).find("gpioinfo shows who"), std::string::npos);
  line().busy = false;
  clocks_.advance(kSecond_ns);
  EXPECT_EQ(told(), "");
  EXPECT_GE(button_.fd(), 0);
}

}  // namespace
}  // namespace roomcal::drivers
