// Button, lamp, trigger, watchdog, service manager and console line make no heap call, from start() through a loss and
// back.

#include <array>
#include <string>

#include <sys/stat.h>

#include "drivers/evdev/evdev_button.h"
#include "drivers/gpio/gpio_button.h"
#include "drivers/gpio/gpio_trigger.h"
#include "drivers/led/led_indicator.h"
#include "drivers/serial/serial_port.h"
#include "drivers/watchdog/hardware_watchdog.h"
#include "drivers/watchdog/service_notifier.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/folder_of_test.h"
#include "tests/drivers/gpio/fake_gpio.h"
#include "tests/drivers/serial/pty.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

class FaceHeap : public test::FolderOfTest {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  }
  DevicePath path(const char* file) const { return std::string_view((folder_ / file).string()); }

  LinuxFileKernel kernel_;
  fakes::ManualClocks clocks_;
  std::size_t calls_ = SIZE_MAX;
  bool ok_ = false;
};

TEST_F(FaceHeap, KeyOfAFifo_NoCall) {
  ASSERT_EQ(::mkfifo((folder_ / "button").c_str(), 0600), 0);
  EvdevButton button({path("button"), KEY_SETUP}, kernel_, clocks_);
  input_event press{};
  press.type = EV_KEY;
  press.code = KEY_SETUP;
  press.value = 1;
  {
    const budget::HeapGuard guard;
    ports::ButtonEdge edge;
    ok_ = button.start().ok() && ::write(button.fd(), &press, sizeof press) == sizeof press && button.next(edge);
    ok_ = ok_ && edge.down && !button.next(edge);
    button.stop();
    clocks_.advance(10 * Retry::kPeriod_ns);
    ok_ = ok_ && !button.next(edge) && button.start().ok();
    calls_ = guard.calls();
  }
  EXPECT_TRUE(ok_);
  EXPECT_EQ(calls_, 0U);
}

TEST_F(FaceHeap, GpioButtonAndTrigger_NoCall) {
  fakes::FakeFileKernel kernel;
  test::FakeGpio gpio(kernel);
  gpio.add("/dev/gpiochip0", "soc", {"button", "trigger"});
  test::FakeGpio::Line& pressed = gpio.chips["/dev/gpiochip0"].lines[0];
  gpio.chips["/dev/gpiochip0"].lines[1].written.reserve(100);
  GpioButtonOptions button_options;
  button_options.line.line = "button";
  GpioTriggerOptions trigger_options;
  trigger_options.line.line = "trigger";
  GpioButton button(button_options, kernel, clocks_);
  GpioTrigger trigger(trigger_options, kernel, clocks_);
  ASSERT_TRUE(button.start().ok());
  ASSERT_TRUE(trigger.start().ok());
  {
    const budget::HeapGuard guard;
    ok_ = true;
    for (int i = 0; i < 10; ++i) {
      ports::ButtonEdge edge;
      test::FakeGpio::change(pressed, i % 2 == 0, i);
      ok_ = ok_ && button.next(edge) && trigger.fire().ok();
    }
    calls_ = guard.calls();
  }
  EXPECT_TRUE(ok_);
  EXPECT_EQ(calls_, 0U);
}

TEST_F(FaceHeap, LampWatchdogAndManager_NoCall) {
  write("trigger", "none [heartbeat]\n");
  write("brightness", "1\n");
  write("watchdog", "");
  const std::string nobody = (folder_ / "notify").string();
  fakes::FakeFileKernel kernel;
  kernel.on_ioctl = [](int, unsigned long, void*) { return 0; };
  LedIndicator lamp({path("")}, kernel_);
  HardwareWatchdog dog({path("watchdog"), 10}, kernel);
  ServiceNotifier notifier;
  {
    const budget::HeapGuard guard;
    ok_ = lamp.start().ok() && dog.start().ok() && !notifier.start(nobody.c_str()).ok();
    for (int i = 0; i < 10; ++i) {
      lamp.set(i % 2 == 0);
      dog.feed();
      notifier.feed();
      notifier.status("idle");
    }
    lamp.stop();
    dog.stop_in_order();
    calls_ = guard.calls();
  }
  EXPECT_TRUE(ok_);
  EXPECT_EQ(notifier.unsent(), 20U);
  EXPECT_EQ(calls_, 0U);
}

TEST_F(FaceHeap, SerialLineThroughALoss_NoCall) {
  auto pty = std::make_unique<test::Pty>();
  std::filesystem::create_symlink(pty->path(), folder_ / "console");
  SerialPort port({path("console")}, kernel_, clocks_);
  ASSERT_TRUE(port.start().ok());
  pty->type("help");
  std::array<char, 16> bytes{};
  std::size_t before_loss = 0, after_loss = 0;
  const auto use = [&](std::size_t& calls) {
    const budget::HeapGuard guard;
    for (int i = 0; i < 10; ++i) {
      ok_ = port.write_some(std::string_view("ok")) == 2 || port.fd() < 0;
      static_cast<void>(port.read_some(bytes));
      clocks_.advance(Retry::kPeriod_ns);
    }
    calls = guard.calls();
  };
  use(before_loss);
  pty.reset();
  use(after_loss);
  EXPECT_TRUE(ok_);
  EXPECT_EQ(port.times_lost(), 1U);
  EXPECT_EQ(before_loss + after_loss, 0U);
}

}  // namespace
}  // namespace roomcal::drivers
