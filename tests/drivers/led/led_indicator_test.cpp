#include "drivers/led/led_indicator.h"

#include <cerrno>

#include "tests/drivers/folder_of_test.h"
#include "tests/fakes/fake_file_kernel.h"

namespace roomcal::drivers {
namespace {

using fakes::FakeFileKernel;
using Call = FakeFileKernel::Call;

class LedIndicatorTest : public test::FolderOfTest {
 protected:
  FakeFileKernel kernel_;
  LedIndicator lamp_{{std::string_view(folder_.string())}, kernel_};
};

TEST_F(LedIndicatorTest, LampOfTheKernel_IsTakenOverAndGivenBack) {
  write("trigger", "none rc-feedback [heartbeat] timer\n");
  write("brightness", "17\n");
  write("max_brightness", "255\n");
  ASSERT_TRUE(lamp_.start().ok());
  EXPECT_EQ(read("trigger"), "none");
  EXPECT_EQ(read("brightness"), "0");
  lamp_.set(true);
  EXPECT_EQ(read("brightness"), "255");
  lamp_.set(false);
  EXPECT_EQ(read("brightness"), "0");
  lamp_.stop();
  EXPECT_EQ(read("trigger"), "heartbeat");
  EXPECT_EQ(read("brightness"), "17");
  lamp_.set(true);
  EXPECT_EQ(read("brightness"), "17") << "it is no longer ours";
}

TEST_F(LedIndicatorTest, PlainFolder_ServesAsALamp) {
  ASSERT_TRUE(lamp_.start().ok());
  lamp_.set(true);
  EXPECT_EQ(read("brightness"), "1");
  lamp_.set(false);
  EXPECT_EQ(read("brightness"), "0");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "trigger"));
}

TEST_F(LedIndicatorTest, SameAgain_IsNotWritten) {
  ASSERT_TRUE(lamp_.start().ok());
  const int before = kernel_.count(Call::kWrite);
  for (int i = 0; i < 10; ++i) lamp_.set(true);
  EXPECT_EQ(kernel_.count(Call::kWrite) - before, 1);
}

TEST_F(LedIndicatorTest, WriteThatFails_IsMadeUpFor) {
  ASSERT_TRUE(lamp_.start().ok());
  for (const Call call : {Call::kOpen, Call::kWrite}) {
    lamp_.set(false);
    kernel_.fail(call, 0, 1, EIO);
    lamp_.set(true);
    EXPECT_EQ(read("brightness").find('1'), std::string::npos);
    lamp_.set(true);
    EXPECT_EQ(read("brightness"), "1");
  }
}

TEST_F(LedIndicatorTest, DriverLoadedAnew_GoesOn) {
  ASSERT_TRUE(lamp_.start().ok());
  std::filesystem::remove(folder_ / "brightness");
  lamp_.set(true);
  EXPECT_EQ(read("brightness"), "1");
}

TEST_F(LedIndicatorTest, NoSuchLamp_IsNamed) {
  LedIndicator nowhere({"/sys/class/leds/there-is-none"}, kernel_);
  EXPECT_EQ(nowhere.start().code(), StatusCode::kUnavailable);
  nowhere.set(true);
  nowhere.stop();
}

TEST_F(LedIndicatorTest, TriggerThatCannotBeTakenOff_IsNamedAndLeft) {
  write("trigger", "none [timer]\n");
  write("brightness", "1\n");
  kernel_.fail(Call::kWrite, 0, 1, EACCES);
  const Status started = lamp_.start();
  EXPECT_EQ(started.code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(started.detail()).find("trigger"), std::string::npos);
  EXPECT_EQ(read("brightness"), "1\n");
}

// One trigger a processor core and more: the list may be longer than what is read of it.
TEST_F(LedIndicatorTest, ListOfTriggersCutBeforeItsChoice_IsTakenOffAndStaysOff) {
  std::string list = "none";
  for (int i = 0; i < 600; ++i) list += " cpu" + std::to_string(i) + "-active";
  write("trigger", list + " [timer]\n");
  ASSERT_TRUE(lamp_.start().ok());
  EXPECT_EQ(read("trigger"), "none");
  lamp_.stop();
  EXPECT_EQ(read("trigger"), "none");
}

TEST_F(LedIndicatorTest, OddTriggerFiles_DoNoHarm) {
  for (const char* text :
       {"", "[", "]a[", "[]", "[a-name-that-is-far-longer-than-any-trigger-of-the-kernel-ever-was]"}) {
    write("trigger", text);
    ASSERT_TRUE(lamp_.start().ok()) << text;
    lamp_.stop();
  }
}

}  // namespace
}  // namespace roomcal::drivers
