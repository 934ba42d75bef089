#include "board/common/start_counter.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace roomcal::board {
namespace {

class StartCounterTest : public testing::Test {
 protected:
  StartCounterTest() { std::filesystem::create_directories(folder_); }
  ~StartCounterTest() override { std::filesystem::remove_all(folder_); }

  StartCounter start(const std::string& boot = "boot-a") const { return {folder_ / "starts", boot}; }
  int begin(const std::string& boot = "boot-a") const { return start(boot).begin(); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("roomcal_starts_" + std::to_string(::getpid()) + "_" +
                                                testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(StartCounterTest, CrashesInARow_AreCounted) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(begin(), i);
  EXPECT_GE(begin(), StartCounter::kTooMany);
}

TEST_F(StartCounterTest, PowerCuts_AreNone) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(begin("boot-" + std::to_string(i)), 0);
}

TEST_F(StartCounterTest, PowerCutBetweenCrashes_ForgetsNoCrash) {
  EXPECT_EQ(begin(), 0);
  EXPECT_EQ(begin(), 1);
  EXPECT_EQ(begin("boot-b"), 1);
  EXPECT_EQ(begin("boot-b"), 2);
}

TEST_F(StartCounterTest, PowerCutInSafeMode_StaysInSafeMode) {
  for (int i = 0; i < StartCounter::kTooMany; ++i) EXPECT_EQ(begin(), i);
  EXPECT_EQ(begin(), StartCounter::kTooMany);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(begin("boot-" + std::to_string(i)), StartCounter::kTooMany);
}

TEST_F(StartCounterTest, MachineThatTellsNoBootId_CountsEveryStart) {
  for (int i = 0; i < 4; ++i) EXPECT_EQ(begin(""), i);
}

TEST_F(StartCounterTest, HangThatAWatchdogEnds_IsCounted) {
  for (int i = 0; i < 4; ++i) {
    StartCounter counter = start("boot-" + std::to_string(i));
    EXPECT_EQ(counter.begin(), i);
    counter.hangs(true);
  }
}

TEST_F(StartCounterTest, HangAfterAMinute_IsTheFirstOfARow) {
  EXPECT_EQ(begin(), 0);
  StartCounter counter = start();
  EXPECT_EQ(counter.begin(), 1);
  counter.well();
  counter.hangs(true);
  EXPECT_EQ(begin("boot-b"), 1);
}

TEST_F(StartCounterTest, ThreadThatAnswersAgain_IsNoHang) {
  StartCounter counter = start();
  EXPECT_EQ(counter.begin(), 0);
  counter.hangs(true);
  counter.hangs(false);
  EXPECT_EQ(begin("boot-b"), 0);
}

TEST_F(StartCounterTest, OrderedEnd_StartsAnew) {
  EXPECT_EQ(begin(), 0);
  StartCounter counter = start();
  EXPECT_EQ(counter.begin(), 1);
  counter.well();
  EXPECT_EQ(begin(), 0);
}

TEST_F(StartCounterTest, FileOfNonsense_CountsAsNone) {
  for (const char* text : {"", "x", "-7 a runs", "99999 a runs", "1", "\xff\xfe"}) {
    std::ofstream(folder_ / "starts") << text;
    EXPECT_LE(begin(), 1) << text;
  }
}

TEST_F(StartCounterTest, FolderThatIsNotThere_CountsNothing) {
  StartCounter counter(folder_ / "none" / "starts", "boot-a");
  EXPECT_EQ(counter.begin(), 0);
  EXPECT_EQ(counter.begin(), 0);
}

TEST(BootId, ThisMachine_HasOne) {
  EXPECT_EQ(boot_id().size(), 36U);
  EXPECT_EQ(boot_id(), boot_id());
}

}  // namespace
}  // namespace roomcal::board
