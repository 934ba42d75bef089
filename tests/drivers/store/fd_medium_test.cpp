#include "drivers/store/fd_medium.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "runtime/store/store.h"
#include "tests/runtime/store/sample_record.h"

namespace roomcal::drivers {
namespace {

namespace fs = std::filesystem;
using store::test::same_content;
using store::test::sample_record;

constexpr std::size_t kSize = 16 * 4096;

class FdMediumTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override {
    fs::permissions(folder, fs::perms::owner_all);
    fs::remove_all(folder);
  }

  MediumOptions options(MediumKind kind = MediumKind::kFile, std::size_t page = 256) const {
    return {kind, path.c_str(), kind == MediumKind::kFile ? kSize : 0, page};
  }
  // One start of the device: opens medium and store anew.
  template <typename Use>
  void start(const MediumOptions& with, const Use& use) {
    FdMedium medium;
    const Status opened = medium.open(with);
    ASSERT_TRUE(opened.ok()) << opened.detail() << ": " << std::strerror(medium.error_number());
    std::vector<std::byte> block(store::plan_store_bytes(medium.page_bytes()));
    Arena arena(block);
    store::Store store;
    ASSERT_TRUE(store.open(medium, arena).ok());
    use(store);
  }

  fs::path folder = fs::temp_directory_path() / ("roomcal_medium_" + std::to_string(::getpid()) + "_" +
                                                 testing::UnitTest::GetInstance()->current_test_info()->name());
  std::string path = folder / "store";
};

TEST_F(FdMediumTest, File_KeepsRecordsOverRestarts) {
  start(options(), [](store::Store& store) {
    EXPECT_EQ(store.state(), store::State::kUncalibrated);
    EXPECT_TRUE(store.provision(sample_record(100), 1).ok());
    for (uint64_t seed = 1; seed <= 3; ++seed) EXPECT_TRUE(store.commit(sample_record(seed), 2).ok());
  });
  EXPECT_EQ(fs::file_size(path), kSize);
  EXPECT_FALSE(fs::exists(path + ".new"));
  start(options(), [](store::Store& store) {
    ASSERT_EQ(store.state(), store::State::kCalibrated);
    EXPECT_TRUE(same_content(*store.current(), sample_record(3)));
    EXPECT_TRUE(store.undo(3).ok());
  });
  start(options(), [](store::Store& store) { EXPECT_TRUE(same_content(*store.current(), sample_record(2))); });
}

TEST_F(FdMediumTest, DeviceNode_TakesItsOwnSize) {
  std::ofstream(path, std::ios::binary) << std::string(kSize + 100, '\xff');  // a file stands in for the node
  for (const MediumKind kind : {MediumKind::kPartition, MediumKind::kNvmem}) {
    const MediumOptions with = options(kind, kind == MediumKind::kNvmem ? 64 : 512);
    start(with, [](store::Store& store) { EXPECT_TRUE(store.commit(sample_record(5), 0).ok()); });
    start(with, [](store::Store& store) { EXPECT_TRUE(same_content(*store.current(), sample_record(5))); });
    fs::resize_file(path, 0);
    fs::resize_file(path, kSize + 100);
  }
}

TEST_F(FdMediumTest, FullDiskAtTheFirstStart_IsAClearErrorAndLeavesNothing) {
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = kSize / 2;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  FdMedium medium;
  const Status opened = medium.open(options());
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(opened.code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(opened.detail()).find("free space"), std::string::npos);
  EXPECT_EQ(medium.error_number(), EFBIG);
  EXPECT_FALSE(fs::exists(path));
  EXPECT_FALSE(fs::exists(path + ".new"));
  EXPECT_TRUE(medium.open(options()).ok());  // space again
}

TEST_F(FdMediumTest, DiskThatFillsUpLater_LeavesTheOldRecord) {
  start(options(), [](store::Store& store) { ASSERT_TRUE(store.commit(sample_record(1), 0).ok()); });
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  start(options(), [&](store::Store& store) {
    rlimit small = before;
    small.rlim_cur = 8192;  // stands in for a file system that has nothing behind the file
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const Status committed = store.commit(sample_record(2), 0);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    EXPECT_EQ(committed.code(), StatusCode::kUnavailable);
    EXPECT_TRUE(same_content(*store.current(), sample_record(1)));
  });
  std::signal(SIGXFSZ, handler);
  start(options(), [](store::Store& store) { EXPECT_TRUE(same_content(*store.current(), sample_record(1))); });
}

TEST_F(FdMediumTest, ReadOnlyFile_IsReadAndNotWritten) {
  start(options(), [](store::Store& store) { ASSERT_TRUE(store.commit(sample_record(1), 0).ok()); });
  fs::permissions(path, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  const uid_t user = ::geteuid();
  constexpr uid_t kNobody = 65534;  // for the superuser no file is read-only
  if (user == 0) {
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  start(options(), [](store::Store& store) {
    EXPECT_TRUE(same_content(*store.current(), sample_record(1)));
    const Status committed = store.commit(sample_record(2), 0);
    EXPECT_EQ(committed.code(), StatusCode::kUnavailable);
    EXPECT_STREQ(committed.detail(), "the store's medium is read-only");
    EXPECT_TRUE(same_content(*store.current(), sample_record(1)));
  });
  ASSERT_EQ(::seteuid(user), 0);
}

TEST_F(FdMediumTest, NoFolder_IsNamed) {
  path = folder / "missing" / "store";
  FdMedium medium;
  const Status opened = medium.open(options());
  EXPECT_EQ(opened.code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(opened.detail()).find("folder exists"), std::string::npos);
  EXPECT_EQ(medium.open(options(MediumKind::kNvmem)).code(), StatusCode::kUnavailable);
}

TEST_F(FdMediumTest, FileOfAnotherSize_IsLeftAlone) {
  std::ofstream(path) << "short";
  FdMedium medium;
  EXPECT_EQ(medium.open(options()).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(fs::file_size(path), 5U);
}

TEST_F(FdMediumTest, ImpossibleSizes_AreRefused) {
  FdMedium medium;
  EXPECT_EQ(medium.open({MediumKind::kFile, path.c_str(), kSize, 100}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(medium.open({MediumKind::kFile, path.c_str(), 0, 256}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(medium.open({MediumKind::kFile, path.c_str(), kSize + 1, 256}).code(), StatusCode::kInvalidArgument);
  ASSERT_TRUE(medium.open(options()).ok());
  std::vector<std::byte> page(256);
  EXPECT_EQ(medium.write_page(128, page).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(medium.write_page(kSize, page).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(medium.read(kSize - 100, page).code(), StatusCode::kOutOfRange);
}

}  // namespace
}  // namespace roomcal::drivers
