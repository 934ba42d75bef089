#include "drivers/replay/replay_cursor.h"

#include <string>

#include "tests/drivers/replay/replay_folder.h"

namespace roomcal::drivers {
namespace {

class ReplayCursorTest : public test::ReplayFolder {
 protected:
  std::string file(int shot) const {
    return std::string(cursor_.path(shot, "cam0", ".pgm").data()).substr(folder_.string().size());
  }
  ReplayCursor cursor_;
};

TEST_F(ReplayCursorTest, NumberedShots_AreCountedUpToTheFirstGap) {
  for (const char* shot : {"shot000", "shot001", "shot003"}) std::filesystem::create_directory(folder_ / shot);
  ASSERT_TRUE(cursor_.open(path(), 5).ok());
  EXPECT_EQ(cursor_.shots(), 2);
  EXPECT_EQ(cursor_.epoch_ns(), 5);
  EXPECT_EQ(file(0), "/shot000/cam0.pgm");
  EXPECT_EQ(file(42), "/shot042/cam0.pgm");
  EXPECT_EQ(file(999), "/shot999/cam0.pgm");
}

TEST_F(ReplayCursorTest, FolderWithoutNumbers_IsTheOneShot) {
  ASSERT_TRUE(cursor_.open(path(), 0).ok());
  EXPECT_EQ(cursor_.shots(), 1);
  EXPECT_EQ(file(0), "/cam0.pgm");
  cursor_.advance(100);
  EXPECT_EQ(cursor_.at(200).shot, 0);
  EXPECT_EQ(cursor_.at(200).since_ns, 100);
}

TEST_F(ReplayCursorTest, Advance_HoldsFromThatMomentOn) {
  for (const char* shot : {"shot000", "shot001", "shot002"}) std::filesystem::create_directory(folder_ / shot);
  ASSERT_TRUE(cursor_.open(path(), 0).ok());
  EXPECT_EQ(cursor_.at(99).shot, 0);
  cursor_.advance(100);
  EXPECT_EQ(cursor_.at(99).shot, 0);
  EXPECT_EQ(cursor_.at(100).shot, 1);
  cursor_.advance(200);
  cursor_.advance(300);
  EXPECT_EQ(cursor_.at(299).shot, 2);
  EXPECT_EQ(cursor_.at(300).shot, 0) << "after the last comes the first";
}

TEST_F(ReplayCursorTest, NoSuchFolder_IsNamed) {
  EXPECT_EQ(cursor_.open("/nowhere/at/all", 0).code(), StatusCode::kNotFound);
  EXPECT_EQ(cursor_.open(std::string_view(std::string(300, 'x')), 0).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(cursor_.shots(), 0);
}

}  // namespace
}  // namespace roomcal::drivers
