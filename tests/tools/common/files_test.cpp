#include "tools/common/files.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;

using test::contains;
using test::refusal;

class Files : public test::FolderTest {};

TEST_F(Files, WriteAtomic_ReplacesAndLeavesNothingBeside) {
  write_atomic(path("a"), "one");
  write_atomic(path("a"), "two");
  EXPECT_EQ(read_text(path("a")), "two");
  EXPECT_FALSE(fs::exists(path("a.new")));
}

TEST_F(Files, WriteAtomicThroughALink_KeepsTheLink) {
  write_atomic(path("a"), "one");
  fs::create_symlink("a", path("link"));
  write_atomic(path("link"), "two");
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(read_text(path("a")), "two");
}

/// A device is written into: replaced by a file, /dev/stdout would be lost to the whole machine.
TEST_F(Files, WriteAtomicToADevice_LeavesItADevice) {
  write_atomic("/dev/null", "one");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_TRUE(contains(refusal([] { write_atomic("/dev/full", "one"); }), "/dev/full: cannot be written"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(Files, WriteAtomicToAFolder_IsRefusedAndLeavesNothingBeside) {
  fs::create_directories(path("d"));
  EXPECT_TRUE(contains(refusal([&] { write_atomic(path("d"), "one"); }), "is a folder"));
  EXPECT_FALSE(fs::exists(path("d.new")));
  EXPECT_TRUE(contains(refusal([&] { write_atomic(path("no/a"), "one"); }), "does its folder exist"));
}

TEST_F(Files, MakeFolder_NamesWhatStandsInTheWay) {
  make_folder(path("x/y"));
  make_folder(path("x/y"));
  EXPECT_TRUE(fs::is_directory(path("x/y")));
  write_atomic(path("f"), "one");
  for (const char* blocked : {"f", "f/g"})
    EXPECT_TRUE(contains(refusal([&] { make_folder(path(blocked)); }), blocked)) << blocked;
}

TEST_F(Files, ReadBytes_WantsAFile) {
  EXPECT_TRUE(contains(refusal([] { read_bytes("/dev/null"); }), "name a file"));
  EXPECT_TRUE(contains(refusal([&] { read_bytes(path("none")); }), "no such file"));
  EXPECT_TRUE(contains(refusal([&] { read_bytes(path(".")); }), "is a folder"));
}

}  // namespace
}  // namespace roomcal::tools
