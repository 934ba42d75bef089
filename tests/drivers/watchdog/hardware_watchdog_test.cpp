#include "drivers/watchdog/hardware_watchdog.h"

#include <cerrno>
#include <optional>
#include <string>

#include <linux/watchdog.h>

#include "tests/drivers/folder_of_test.h"
#include "tests/fakes/fake_file_kernel.h"

namespace roomcal::drivers {
namespace {

using fakes::FakeFileKernel;
using Call = FakeFileKernel::Call;

// A file stands in for the device: it keeps what was written.
class HardwareWatchdogTest : public test::FolderOfTest {
 protected:
  void SetUp() override {
    write("watchdog", "");
    kernel_.on_ioctl = [this](int, unsigned long request, void* argument) {
      auto& seconds = *static_cast<int*>(argument);
      if (request == WDIOC_SETTIMEOUT) {
        if (!settable_) return -EOPNOTSUPP;
        device_s_ = (seconds + step_s_ - 1) / step_s_ * step_s_;
      }
      if (request != WDIOC_SETTIMEOUT && request != WDIOC_GETTIMEOUT) return -ENOTTY;
      seconds = device_s_;
      return 0;
    };
  }
  Status start(int timeout_s = 10) {
    dog_.emplace(WatchdogOptions{std::string_view((folder_ / "watchdog").string()), timeout_s}, kernel_);
    return dog_->start();
  }
  std::string written() const { return read("watchdog"); }

  FakeFileKernel kernel_;
  int device_s_ = 60, step_s_ = 1;
  bool settable_ = true;
  std::optional<HardwareWatchdog> dog_;
};

TEST_F(HardwareWatchdogTest, Started_HasItsTimeAndIsFed) {
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(device_s_, 10);
  EXPECT_EQ(dog_->timeout_s(), 10);
  dog_->feed();
  dog_->feed();
  EXPECT_EQ(written(), std::string(3, '\0'));
}

TEST_F(HardwareWatchdogTest, StoppedInOrder_SaysTheMagicCharacter) {
  ASSERT_TRUE(start().ok());
  dog_->stop_in_order();
  EXPECT_EQ(written(), std::string("\0V", 2));
  dog_->feed();
  dog_->stop_in_order();
  EXPECT_EQ(written(), std::string("\0V", 2));
}

TEST_F(HardwareWatchdogTest, Destroyed_LeavesItRunning) {
  ASSERT_TRUE(start().ok());
  dog_.reset();
  EXPECT_EQ(written().find('V'), std::string::npos);
}

TEST_F(HardwareWatchdogTest, DeviceThatRounds_TellsWhatItHas) {
  step_s_ = 16;
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(dog_->timeout_s(), 16);
}

TEST_F(HardwareWatchdogTest, DeviceThatCannotBeSet_IsNamedAndFedAllTheSame) {
  settable_ = false;
  EXPECT_EQ(start(10).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(dog_->timeout_s(), 60);
  dog_->feed();
  EXPECT_EQ(written(), std::string(2, '\0'));
  EXPECT_TRUE(start(45).ok()) << "60 s instead of 45 s will do";
}

TEST_F(HardwareWatchdogTest, TakenOrAbsent_IsNamed) {
  kernel_.fail(Call::kOpen, 0, 1, EBUSY);
  EXPECT_NE(std::string(start().detail()).find("RuntimeWatchdogSec"), std::string::npos);
  std::filesystem::remove(folder_ / "watchdog");
  EXPECT_EQ(start().code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(start().detail()).find("module"), std::string::npos);
  EXPECT_EQ(start(0).code(), StatusCode::kInvalidArgument);
  dog_->feed();
  dog_->stop_in_order();
  EXPECT_EQ(dog_->failed_feeds(), 0U);
}

TEST_F(HardwareWatchdogTest, FeedsThatFail_AreCounted) {
  ASSERT_TRUE(start().ok());
  kernel_.fail(Call::kWrite, 0, 3, EIO);
  for (int i = 0; i < 5; ++i) dog_->feed();
  EXPECT_EQ(dog_->failed_feeds(), 3U);
}

TEST_F(HardwareWatchdogTest, ControlCallsFailing_ItIsFedAllTheSame) {
  for (int at = 0; at < 3; ++at) {
    write("watchdog", "");
    device_s_ = 10;
    kernel_.fail(Call::kIoctl, at, 1, EIO);
    EXPECT_TRUE(start().ok()) << at;
    EXPECT_EQ(written(), std::string(1, '\0'));
  }
  kernel_.fail(Call::kIoctl, 0, 2, ENOTTY);
  EXPECT_EQ(start().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace roomcal::drivers
