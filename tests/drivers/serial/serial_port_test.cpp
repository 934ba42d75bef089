#include "drivers/serial/serial_port.h"

#include <cerrno>
#include <memory>
#include <optional>

#include "drivers/os/linux_clocks.h"
#include "drivers/os/wait.h"
#include "tests/drivers/folder_of_test.h"
#include "tests/drivers/serial/pty.h"
#include "tests/fakes/fake_file_kernel.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using fakes::FakeFileKernel;
using Call = FakeFileKernel::Call;
using test::Pty;

class SerialPortTest : public test::FolderOfTest {
 protected:
  void SetUp() override { plug(); }
  // The adapter's path stays, the terminal behind it is another one.
  void plug() {
    pty_ = std::make_unique<Pty>();
    std::filesystem::remove(link_);
    std::filesystem::create_symlink(pty_->path(), link_);
  }
  void unplug() {
    pty_.reset();
    std::filesystem::remove(link_);
  }
  SerialOptions options(uint32_t baud = 115'200) const { return {std::string_view(link_.string()), baud}; }
  std::string read() {
    std::array<char, 64> bytes{};
    return {bytes.data(), port_.read_some(bytes)};
  }
  std::size_t write(const std::string& text) { return port_.write_some(text); }

  const std::filesystem::path link_ = folder_ / "console";
  std::unique_ptr<Pty> pty_;
  FakeFileKernel kernel_;
  fakes::ManualClocks clocks_;
  SerialPort port_{options(), kernel_, clocks_};
};

TEST_F(SerialPortTest, EveryByte_PassesAsItIs) {
  ASSERT_TRUE(port_.start().ok());
  std::string all;
  for (int i = 1; i < 256; ++i) all.push_back(static_cast<char>(i));
  all.push_back('\0');
  pty_->type(all);
  std::string got;
  for (std::string part; !(part = read()).empty();) got += part;
  EXPECT_EQ(got, all);
  EXPECT_EQ(write(all), all.size());
  EXPECT_EQ(pty_->screen(), all) << "nothing is echoed, nothing added";
  EXPECT_EQ(read(), "");
}

TEST_F(SerialPortTest, Rate_IsSet) {
  ASSERT_TRUE(port_.start().ok());
  termios settings = pty_->settings();
  EXPECT_EQ(::cfgetospeed(&settings), speed_t{B115200});
  SerialPort fast(options(460'800), kernel_, clocks_);
  ASSERT_TRUE(fast.start().ok());
  settings = pty_->settings();
  EXPECT_EQ(::cfgetispeed(&settings), speed_t{B460800});
}

TEST_F(SerialPortTest, BytesWaiting_WakeTheLoop) {
  ASSERT_TRUE(port_.start().ok());
  EXPECT_EQ(wait_readable(std::array{port_.fd()}, LinuxClocks().now_ns()), 0U);
  pty_->type("x");
  EXPECT_EQ(wait_readable(std::array{port_.fd()}, LinuxClocks().now_ns() + 1'000'000'000), 1U);
  EXPECT_EQ(read(), "x");
}

TEST_F(SerialPortTest, NobodyReads_TakesWhatFitsAndNeverWaits) {
  ASSERT_TRUE(port_.start().ok());
  const std::string line(1000, 'x');
  std::size_t taken = 0;
  for (int i = 0; i < 1000; ++i) taken += write(line);
  EXPECT_GT(taken, 0U);
  EXPECT_LT(taken, 1'000'000U);
  EXPECT_EQ(write("y"), 0U);
  EXPECT_EQ(pty_->screen().size(), taken);
  EXPECT_EQ(write("y"), 1U);
  EXPECT_EQ(port_.times_lost(), 0U);
}

TEST_F(SerialPortTest, Unplugged_IsOpenedAgainWithoutEnd) {
  ASSERT_TRUE(port_.start().ok());
  for (uint64_t round = 1; round <= 3; ++round) {
    unplug();
    EXPECT_EQ(read(), "");
    EXPECT_EQ(port_.times_lost(), round);
    EXPECT_EQ(port_.fd(), -1);
    for (int i = 0; i < 100; ++i) {
      clocks_.advance(Retry::kPeriod_ns);
      EXPECT_EQ(read(), "");
      EXPECT_EQ(write("lost"), 0U);
    }
    plug();
    EXPECT_EQ(read(), "") << "looked for once a second only";
    EXPECT_EQ(port_.fd(), -1);
    clocks_.advance(Retry::kPeriod_ns);
    EXPECT_EQ(write("here"), 4U);
    EXPECT_EQ(pty_->screen(), "here");
    pty_->type("there");
    EXPECT_EQ(read(), "there");
  }
}

TEST_F(SerialPortTest, AbsentAtTheStart_IsUsedWhenItComes) {
  unplug();
  EXPECT_EQ(port_.start().code(), StatusCode::kUnavailable);
  plug();
  clocks_.advance(Retry::kPeriod_ns);
  pty_->type("hello");  // kept by the terminal until somebody opens its far end
  EXPECT_EQ(write("x"), 1U);
  EXPECT_EQ(port_.times_lost(), 0U);
}

TEST_F(SerialPortTest, EveryCallFailingOnce_TheLineComesBack) {
  for (const Call call : {Call::kOpen, Call::kRead, Call::kWrite}) {
    for (const int error : {EIO, ENODEV, ENXIO, EAGAIN}) {
      for (int at = 0; at < 4; ++at) {
        plug();
        kernel_.heal();
        SerialPort port(options(), kernel_, clocks_);
        kernel_.fail(call, at, 1, error);
        static_cast<void>(port.start().ok());
        std::array<char, 8> bytes{};
        for (int i = 0; i < 6; ++i) {
          static_cast<void>(port.read_some(bytes));
          static_cast<void>(port.write_some(std::string_view("x")));
          clocks_.advance(Retry::kPeriod_ns);
        }
        static_cast<void>(pty_->screen());
        pty_->type("ok");
        EXPECT_EQ(port.read_some(bytes), 2U) << static_cast<int>(call) << " " << error << " " << at;
        EXPECT_EQ(port.write_some(std::string_view("ok")), 2U);
        EXPECT_EQ(pty_->screen(), "ok");
      }
    }
  }
}

TEST_F(SerialPortTest, WhatIsNoLine_IsNamed) {
  unplug();
  FolderOfTest::write("console", "a file");
  EXPECT_EQ(port_.start().code(), StatusCode::kUnsupported);
  EXPECT_EQ(port_.fd(), -1);
  EXPECT_EQ(FolderOfTest::read("console"), "a file");
  SerialPort nowhere({""}, kernel_, clocks_);
  EXPECT_EQ(nowhere.start().code(), StatusCode::kInvalidArgument);
  plug();
  SerialPort odd(options(115'201), kernel_, clocks_);
  EXPECT_EQ(odd.start().code(), StatusCode::kInvalidArgument);
  clocks_.advance(Retry::kPeriod_ns);
  EXPECT_EQ(odd.write_some(std::string_view("x")), 0U) << "not tried again";
}

TEST_F(SerialPortTest, Stopped_StaysStopped) {
  ASSERT_TRUE(port_.start().ok());
  port_.stop();
  pty_->type("x");
  clocks_.advance(10 * Retry::kPeriod_ns);
  EXPECT_EQ(read(), "");
  EXPECT_EQ(write("x"), 0U);
  EXPECT_EQ(port_.fd(), -1);
}

TEST_F(SerialPortTest, EmptySpans_AreNothing) {
  ASSERT_TRUE(port_.start().ok());
  EXPECT_EQ(port_.read_some({}), 0U);
  EXPECT_EQ(port_.write_some({}), 0U);
  EXPECT_EQ(port_.times_lost(), 0U);
}

}  // namespace
}  // namespace roomcal::drivers
