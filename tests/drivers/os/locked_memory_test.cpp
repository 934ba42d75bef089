#include "drivers/os/locked_memory.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "drivers/os/page_faults.h"
#include "tests/drivers/as_nobody.h"
#include "tests/drivers/emulated.h"

namespace roomcal::drivers {
namespace {

using test::AsNobody;

constexpr std::size_t kBytes = 1024 * 1024;

// While it lives, the process may lock no memory.
class NoLocking {
 public:
  NoLocking() {
    EXPECT_EQ(::getrlimit(RLIMIT_MEMLOCK, &before_), 0);
    rlimit none = before_;
    none.rlim_cur = 0;
    EXPECT_EQ(::setrlimit(RLIMIT_MEMLOCK, &none), 0);
  }
  ~NoLocking() { EXPECT_EQ(::setrlimit(RLIMIT_MEMLOCK, &before_), 0); }

 private:
  rlimit before_{};
};

// Writes every page and returns how many of them had to be brought in. An emulator has faults of its own: 0.
uint64_t faults_of_writing(std::span<std::byte> bytes) {
  const PageFaultMark mark;
  for (std::size_t at = 0; at < bytes.size(); at += 4096) *const_cast<volatile std::byte*>(&bytes[at]) = std::byte{1};
  return test::emulated() ? 0 : mark.since().minor + mark.since().major;
}

TEST(LockedMemory, Reserved_IsZeroWholePagesAndThere) {
  LockedMemory memory;
  ASSERT_TRUE(memory.reserve(kBytes - 100).ok());
  EXPECT_EQ(memory.bytes().size(), kBytes);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory.bytes().data()) % 4096, 0U);
  EXPECT_TRUE(std::all_of(memory.bytes().begin(), memory.bytes().end(), [](std::byte b) { return b == std::byte{0}; }));
  EXPECT_EQ(faults_of_writing(memory.bytes()), 0U);
}

TEST(LockedMemory, LimitForbidsLocking_WorksAndSaysSo) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer answers mlock itself";
#endif
  const AsNobody nobody;
  const NoLocking none;
  LockedMemory memory;
  ASSERT_TRUE(memory.reserve(kBytes).ok());
  EXPECT_EQ(memory.lock_status().code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(memory.lock_status().detail()).find("LimitMEMLOCK"), std::string::npos);
  EXPECT_EQ(faults_of_writing(memory.bytes()), 0U);
}

TEST(LockedMemory, LimitAllowsIt_IsLocked) {
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_MEMLOCK, &limit), 0);
  if (limit.rlim_cur < 2 * kBytes && ::geteuid() != 0)
    GTEST_SKIP() << "this user may lock " << limit.rlim_cur << " bytes";
  LockedMemory memory;
  ASSERT_TRUE(memory.reserve(kBytes).ok());
  EXPECT_TRUE(memory.lock_status().ok()) << memory.lock_status().detail();
}

TEST(LockedMemory, ImpossibleSizes_AreRefused) {
  LockedMemory memory;
  EXPECT_EQ(memory.reserve(0).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(memory.reserve(SIZE_MAX).code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(memory.reserve(SIZE_MAX - kBytes).code(), StatusCode::kOutOfMemory);
  EXPECT_TRUE(memory.bytes().empty());
}

TEST(LockedMemory, Moved_HasOneOwner) {
  LockedMemory first;
  ASSERT_TRUE(first.reserve(kBytes).ok());
  const std::byte* place = first.bytes().data();
  LockedMemory second(std::move(first));
  EXPECT_EQ(second.bytes().data(), place);
  LockedMemory third;
  third = std::move(second);
  EXPECT_EQ(third.bytes().data(), place);
  EXPECT_EQ(faults_of_writing(third.bytes()), 0U);
}

}  // namespace
}  // namespace roomcal::drivers
