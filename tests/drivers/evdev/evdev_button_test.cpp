#include "drivers/evdev/evdev_button.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <vector>

#include <sys/socket.h>
#include <sys/stat.h>

#include "drivers/os/linux_clocks.h"
#include "drivers/os/wait.h"
#include "tests/drivers/folder_of_test.h"
#include "tests/fakes/fake_file_kernel.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using fakes::FakeFileKernel;
using Call = FakeFileKernel::Call;

constexpr uint16_t kKey = KEY_SETUP;
constexpr int64_t kSecond_ns = 1'000'000'000;

input_event event(uint16_t type, uint16_t code, int value, int64_t stamp_ns = 0) {
  input_event result{};
  result.input_event_sec = static_cast<decltype(result.input_event_sec)>(stamp_ns / kSecond_ns);
  result.input_event_usec = static_cast<decltype(result.input_event_usec)>(stamp_ns % kSecond_ns / 1000);
  result.type = type;
  result.code = code;
  result.value = value;
  return result;
}

/// An input device with one key: its kernel answers ioctls, its events come through a socket.
class InputDevice {
 public:
  explicit InputDevice(FakeFileKernel& kernel) : kernel_(kernel) {
    plug();
    kernel.on_open = [this](const char*, int) { return there_ ? FakeFileKernel::share(far_.get()) : -ENODEV; };
    kernel.on_ioctl = [this](int, unsigned long request, void* argument) {
      if (request == EVIOCSCLOCKID) {
        clock = *static_cast<int*>(argument);
        return 0;
      }
      if (request != EVIOCGKEY(KEY_CNT / 8) && request != EVIOCGBIT(EV_KEY, KEY_CNT / 8)) return -ENOTTY;
      const bool set = request == EVIOCGBIT(EV_KEY, KEY_CNT / 8) || down;
      auto* bits = static_cast<uint8_t*>(argument);
      if (set) bits[kKey / 8] = static_cast<uint8_t>(1U << (kKey % 8));
      return KEY_CNT / 8;
    };
  }
  void plug() {
    int ends[2] = {-1, -1};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    near_ = UniqueFd(ends[0]);
    far_ = UniqueFd(ends[1]);
    there_ = true;
  }
  void unplug() {
    near_.reset();
    far_.reset();
    there_ = false;
  }
  void send(const input_event& what) {
    ASSERT_EQ(::send(near_.get(), &what, sizeof what, 0), static_cast<ssize_t>(sizeof what));
  }
  void press(bool to, int64_t stamp_ns) {
    down = to;
    send(event(EV_KEY, kKey, to ? 1 : 0, stamp_ns));
    send(event(EV_SYN, SYN_REPORT, 0, stamp_ns));
  }

  int clock = -1;
  bool down = false;

 private:
  FakeFileKernel& kernel_;
  UniqueFd near_, far_;
  bool there_ = false;
};

class EvdevButtonTest : public testing::Test {
 protected:
  std::vector<ports::ButtonEdge> edges() {
    std::vector<ports::ButtonEdge> result;
    for (ports::ButtonEdge edge; button_.next(edge);) result.push_back(edge);
    return result;
  }
  // "down 5 s", as text, so that failures read well.
  std::string told() {
    std::string text;
    for (const ports::ButtonEdge& edge : edges())
      text += (edge.down ? "down " : "up ") + std::to_string(edge.stamp_ns / 1'000'000) + " ";
    return text;
  }

  FakeFileKernel kernel_;
  fakes::ManualClocks clocks_;
  InputDevice device_{kernel_};
  EvdevButton button_{{"/dev/input/button", kKey}, kernel_, clocks_};
};

TEST_F(EvdevButtonTest, Press_ComesWithItsMonotonicStamps) {
  ASSERT_TRUE(button_.start().ok());
  EXPECT_EQ(device_.clock, CLOCK_MONOTONIC);
  device_.press(true, 5 * kSecond_ns);
  device_.press(false, 8 * kSecond_ns + 1'000'000);
  EXPECT_EQ(told(), "down 5000 up 8001 ");
  EXPECT_EQ(told(), "");
}

TEST_F(EvdevButtonTest, RepeatsAndOtherKeys_AreNoEdges) {
  ASSERT_TRUE(button_.start().ok());
  device_.send(event(EV_KEY, KEY_POWER, 1, 1));
  device_.press(true, kSecond_ns);
  for (int i = 0; i < 5; ++i) device_.send(event(EV_KEY, kKey, 2, 2 * kSecond_ns));
  device_.send(event(EV_REL, kKey, 1, 1));
  EXPECT_EQ(told(), "down 1000 ");
}

TEST_F(EvdevButtonTest, HeldAtTheStart_NoEdgeUntilReleased) {
  device_.down = true;
  ASSERT_TRUE(button_.start().ok());
  device_.press(false, kSecond_ns);
  EXPECT_EQ(told(), "");
  device_.press(true, 2 * kSecond_ns);
  EXPECT_EQ(told(), "down 2000 ");
}

TEST_F(EvdevButtonTest, KernelDroppedEvents_ThePresentStateIsToldOnce) {
  ASSERT_TRUE(button_.start().ok());
  device_.down = true;  // its event was dropped
  device_.send(event(EV_SYN, SYN_DROPPED, 0, kSecond_ns));
  device_.send(event(EV_KEY, kKey, 0, kSecond_ns));  // left over, of before
  device_.send(event(EV_SYN, SYN_REPORT, 0, kSecond_ns));
  EXPECT_EQ(told(), "down 1000 ");
  device_.send(event(EV_SYN, SYN_DROPPED, 0, 2 * kSecond_ns));
  device_.send(event(EV_SYN, SYN_REPORT, 0, 2 * kSecond_ns));
  EXPECT_EQ(told(), "") << "still down";
  device_.press(false, 3 * kSecond_ns);
  EXPECT_EQ(told(), "up 3000 ");
}

TEST_F(EvdevButtonTest, UnpluggedWhileDown_ItsStateIsToldWhenItIsBack) {
  ASSERT_TRUE(button_.start().ok());
  device_.press(true, kSecond_ns);
  EXPECT_EQ(told(), "down 1000 ");
  device_.unplug();
  EXPECT_EQ(told(), "");
  EXPECT_EQ(button_.fd(), -1);
  clocks_.advance(10 * kSecond_ns);
  EXPECT_EQ(told(), "");
  device_.down = false;
  device_.plug();
  EXPECT_EQ(told(), "") << "looked for once a second only";
  clocks_.advance(kSecond_ns);
  EXPECT_EQ(told(), "up " + std::to_string(clocks_.now_ns() / 1'000'000) + " ");
  device_.press(true, 20 * kSecond_ns);
  EXPECT_EQ(told(), "down 20000 ");
}

TEST_F(EvdevButtonTest, AbsentAtTheStart_IsUsedWhenItComes) {
  device_.unplug();
  EXPECT_EQ(button_.start().code(), StatusCode::kNotFound);
  device_.plug();
  device_.down = true;
  clocks_.advance(kSecond_ns);
  EXPECT_EQ(told(), "") << "held when it came";
  device_.press(false, kSecond_ns);
  device_.press(true, 2 * kSecond_ns);
  EXPECT_EQ(told(), "down 2000 ");
}

TEST_F(EvdevButtonTest, EveryCallFailingOnce_TheNextPressIsToldAllTheSame) {
  for (const Call call : {Call::kOpen, Call::kRead, Call::kIoctl}) {
    for (int at = 0;; ++at) {
      FakeFileKernel kernel;
      fakes::ManualClocks clocks;
      InputDevice device(kernel);
      EvdevButton button({"/dev/input/button", kKey}, kernel, clocks);
      kernel.fail(call, at, 1, EIO);
      static_cast<void>(button.start().ok());
      ports::ButtonEdge edge;
      static_cast<void>(button.next(edge));
      clocks.advance(2 * kSecond_ns);
      static_cast<void>(button.next(edge));
      const bool fault_came = kernel.count(call) > at;
      device.press(true, 5 * kSecond_ns);
      bool told = button.next(edge);
      clocks.advance(2 * kSecond_ns);  // a device that failed is opened anew
      told = told || button.next(edge);
      ASSERT_TRUE(told) << "call " << static_cast<int>(call) << " number " << at;
      EXPECT_TRUE(edge.down);
      if (!fault_came) break;
    }
  }
}

TEST_F(EvdevButtonTest, WhatIsNoSuchKey_IsNamed) {
  EvdevButton no_code({"/dev/input/button", 0}, kernel_, clocks_);
  EXPECT_EQ(no_code.start().code(), StatusCode::kInvalidArgument);
  EvdevButton other_code({"/dev/input/button", KEY_POWER}, kernel_, clocks_);
  EXPECT_EQ(other_code.start().code(), StatusCode::kNotFound);
  kernel_.fail(Call::kIoctl, 0, 100, ENOTTY);
  EXPECT_EQ(button_.start().code(), StatusCode::kUnavailable);
}

TEST_F(EvdevButtonTest, FloodOfEvents_DoesNotHoldTheLoopUp) {
  ASSERT_TRUE(button_.start().ok());
  for (int i = 0; i < 200; ++i) device_.send(event(EV_REL, 0, 1, 0));
  const int before = kernel_.count(Call::kRead);
  EXPECT_EQ(told(), "");
  EXPECT_LE(kernel_.count(Call::kRead) - before, 64);
}

class EvdevFifo : public test::FolderOfTest {
 protected:
  void SetUp() override { ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0); }
  // A script: opens, writes, closes.
  void script(const std::vector<input_event>& events, std::size_t piece = sizeof(input_event)) const {
    const UniqueFd fd(::open(path_.c_str(), O_WRONLY | O_NONBLOCK));
    ASSERT_TRUE(fd.valid()) << "nobody reads";
    const auto* bytes = reinterpret_cast<const char*>(events.data());
    const std::size_t size = events.size() * sizeof(input_event);
    for (std::size_t at = 0; at < size; at += piece) {
      const std::size_t part = std::min(piece, size - at);
      ASSERT_EQ(::write(fd.get(), bytes + at, part), static_cast<ssize_t>(part));
    }
  }

  const std::string path_ = folder_ / "button";
  LinuxFileKernel kernel_;
  fakes::ManualClocks clocks_;
  EvdevButton button_{{std::string_view(path_), kKey}, kernel_, clocks_};
};

TEST_F(EvdevFifo, ScriptPresses_WithoutStampsItIsWhenRead) {
  ASSERT_TRUE(button_.start().ok());
  ports::ButtonEdge edge;
  for (int i = 0; i < 3; ++i) {
    script({event(EV_KEY, kKey, 1), event(EV_SYN, SYN_REPORT, 0)});
    ASSERT_TRUE(button_.next(edge));
    EXPECT_TRUE(edge.down);
    EXPECT_EQ(edge.stamp_ns, clocks_.now_ns());
    clocks_.advance(3 * kSecond_ns);
    script({event(EV_KEY, kKey, 0, 7 * kSecond_ns)});
    ASSERT_TRUE(button_.next(edge));
    EXPECT_FALSE(edge.down);
    EXPECT_EQ(edge.stamp_ns, 7 * kSecond_ns);
    EXPECT_FALSE(button_.next(edge));
    EXPECT_EQ(wait_readable(std::array{button_.fd()}, LinuxClocks().now_ns()), 0U) << "a writer's end keeps us awake";
  }
}

TEST_F(EvdevFifo, EventInPieces_IsOneEvent) {
  ASSERT_TRUE(button_.start().ok());
  ports::ButtonEdge edge;
  script({event(EV_KEY, kKey, 1, kSecond_ns), event(EV_KEY, kKey, 0, 2 * kSecond_ns)}, 5);
  std::vector<bool> downs;
  for (int i = 0; i < 20; ++i)
    if (button_.next(edge)) downs.push_back(edge.down);
  EXPECT_EQ(downs, (std::vector<bool>{true, false}));
}

TEST_F(EvdevFifo, DroppedMark_IsNoHarm) {
  ASSERT_TRUE(button_.start().ok());
  ports::ButtonEdge edge;
  script({event(EV_SYN, SYN_DROPPED, 0), event(EV_SYN, SYN_REPORT, 0), event(EV_KEY, kKey, 1)});
  ASSERT_TRUE(button_.next(edge));
  EXPECT_TRUE(edge.down);
}

TEST_F(EvdevFifo, RegularFile_IsNoButton) {
  std::filesystem::remove(path_);
  write("button", std::string(100, '\0'));
  EXPECT_EQ(button_.start().code(), StatusCode::kUnavailable);
  std::filesystem::remove(path_);
  EXPECT_EQ(button_.start().code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace roomcal::drivers
