#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace roomcal::tools::test {

namespace fs = std::filesystem;

/// A test with a folder of its own, empty at the start and gone at the end.
class FolderTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("roomcal_") + info.test_suite_name() + "_" + info.name());
    fs::remove_all(folder_);  // of a run that was killed
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }
  std::string file(const std::string& name) const { return path(name).string(); }

  fs::path folder_;
};

}  // namespace roomcal::tools::test
