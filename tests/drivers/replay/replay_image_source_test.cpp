#include "drivers/replay/replay_image_source.h"

#include <optional>
#include <string>

#include "tests/drivers/replay/replay_folder.h"
#include "tests/fakes/log_lines.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using ports::ImageFault;
using ports::SourceState;

constexpr int kWidth = 6, kHeight = 4;
constexpr int64_t kPeriod_ns = 100'000'000;

class ReplayImageTest : public test::ReplayFolder {
 protected:
  void SetUp() override {
    write_pgm("shot000/cam0.pgm", kWidth, kHeight, 0);
    write_pgm("shot001/cam0.pgm", kWidth, kHeight, 100);
  }
  Status start() {
    EXPECT_TRUE(cursor_.open(path(), clocks_.now_ns()).ok());
    const ReplayImageOptions options = {"cam0", kWidth, kHeight, kPeriod_ns};
    memory_.resize(ReplayImageSource::memory_bytes(options, cursor_.shots()));
    source_.emplace(options, cursor_, clocks_, log_, memory_);
    return source_->start();
  }
  Status next(int64_t wait_ns = 10 * kPeriod_ns) {
    pixels_.assign(8 * kHeight, 255);
    return source_->next(wait_ns, MutableImageView(pixels_.data(), kWidth, kHeight, 8), facts_);
  }
  int first_pixel() const { return pixels_[0]; }

  fakes::ManualClocks clocks_;
  fakes::LogLines log_;
  ReplayCursor cursor_;
  std::vector<std::byte> memory_;
  std::optional<ReplayImageSource> source_;
  std::vector<uint8_t> pixels_;
  ports::ImageFacts facts_;
};

TEST_F(ReplayImageTest, Images_ComeAtTheRateWithTheirPixels) {
  ASSERT_TRUE(start().ok());
  const int64_t epoch_ns = clocks_.now_ns();
  for (uint32_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(next().ok());
    EXPECT_EQ(facts_.exposed, (Stamp{epoch_ns + i * kPeriod_ns, ClockId::kMonotonic}));
    EXPECT_EQ(facts_.arrived_ns, facts_.exposed.ns);
    EXPECT_EQ(facts_.sequence, i);
    EXPECT_EQ(facts_.first_after_gap, i == 0);
  }
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) EXPECT_EQ(pixels_[static_cast<std::size_t>(8 * y + x)], 6 * y + x);
    EXPECT_EQ(pixels_[static_cast<std::size_t>(8 * y + 6)], 255) << "what lies between rows is not ours";
  }
  EXPECT_EQ(source_->health().images, 5U);
  EXPECT_EQ(source_->health().state, SourceState::kStreaming);
}

TEST_F(ReplayImageTest, ReaderWhoComesLate_GetsTheLatest) {
  ASSERT_TRUE(start().ok());
  ASSERT_TRUE(next().ok());
  const int64_t first_ns = facts_.exposed.ns;
  clocks_.advance(kPeriod_ns * 7 / 2);
  ASSERT_TRUE(next(0).ok());
  EXPECT_EQ(facts_.exposed.ns, first_ns + 3 * kPeriod_ns);
  EXPECT_EQ(next(0).code(), StatusCode::kUnavailable);
  EXPECT_EQ(next(kPeriod_ns / 4).code(), StatusCode::kUnavailable);
  ASSERT_TRUE(next(kPeriod_ns / 4).ok());
  EXPECT_EQ(facts_.exposed.ns, first_ns + 4 * kPeriod_ns);
}

TEST_F(ReplayImageTest, BoardGoesOn_TheNextShotIsShownFromThenOn) {
  ASSERT_TRUE(start().ok());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(next().ok());
    EXPECT_EQ(first_pixel(), 0);
  }
  clocks_.advance(kPeriod_ns / 2);
  cursor_.advance(clocks_.now_ns());
  ASSERT_TRUE(next().ok());
  EXPECT_EQ(first_pixel(), 100);
  cursor_.advance(clocks_.now_ns() + 1);
  ASSERT_TRUE(next().ok());
  EXPECT_EQ(first_pixel(), 0);
}

// Two cameras are read one after the other, the board goes on in between: both have exposed the old shot.
TEST_F(ReplayImageTest, BoardGoesOnBetweenTwoCameras_TheyShowTheSameShot) {
  write_pgm("shot000/cam1.pgm", kWidth, kHeight, 0);
  write_pgm("shot001/cam1.pgm", kWidth, kHeight, 100);
  ASSERT_TRUE(start().ok());
  std::vector<std::byte> memory(memory_.size());
  ReplayImageSource second({"cam1", kWidth, kHeight, kPeriod_ns}, cursor_, clocks_, log_, memory);
  ASSERT_TRUE(second.start().ok());
  ASSERT_TRUE(next().ok());
  const Stamp exposed = facts_.exposed;
  clocks_.advance(10);
  cursor_.advance(clocks_.now_ns());
  ASSERT_TRUE(second.next(0, MutableImageView(pixels_.data(), kWidth, kHeight, 8), facts_).ok());
  EXPECT_EQ(facts_.exposed, exposed);
  EXPECT_EQ(first_pixel(), 0);
}

TEST_F(ReplayImageTest, MissingImage_IsLookedForAgain) {
  std::filesystem::remove(folder_ / "shot001/cam0.pgm");
  EXPECT_EQ(start().code(), StatusCode::kNotFound);
  EXPECT_EQ(source_->health().state, SourceState::kRecovering);
  EXPECT_EQ(next(kPeriod_ns).code(), StatusCode::kUnavailable);
  EXPECT_EQ(next(20 * kPeriod_ns).code(), StatusCode::kUnavailable);
  write_pgm("shot001/cam0.pgm", kWidth, kHeight, 100);
  ASSERT_TRUE(next(20 * kPeriod_ns).ok());
  EXPECT_EQ(source_->health().state, SourceState::kStreaming);
  EXPECT_EQ(log_.count("not found"), 1U) << "one line however often";
}

TEST_F(ReplayImageTest, UnfitFiles_AreNamed) {
  const auto says = [&](StatusCode code, ImageFault fault, const std::string& part) {
    const Status started = start();
    EXPECT_EQ(started.code(), code);
    EXPECT_NE(std::string(started.detail()).find(part), std::string::npos) << started.detail();
    EXPECT_EQ(source_->health().last_fault, fault);
    EXPECT_EQ(source_->health().state, SourceState::kFaulted);
    EXPECT_EQ(next(kPeriod_ns).code(), StatusCode::kUnavailable);
  };
  write_pgm("shot001/cam0.pgm", kWidth + 1, kHeight, 0);
  says(StatusCode::kUnsupported, ImageFault::kFormat, "another size");
  write("shot001/cam0.pgm", "P5 6 4 255\nshort");
  says(StatusCode::kUnsupported, ImageFault::kShort, "ends before");
  write("shot001/cam0.pgm", "GIF89a");
  says(StatusCode::kUnsupported, ImageFault::kFormat, "P5");
  write("shot001/cam0.pgm", "");
  says(StatusCode::kUnsupported, ImageFault::kFormat, "P5");
}

TEST_F(ReplayImageTest, TooLittleMemory_IsRefused) {
  ASSERT_TRUE(cursor_.open(path(), 0).ok());
  std::vector<std::byte> memory(2 * kWidth * kHeight - 1);
  ReplayImageSource source({"cam0", kWidth, kHeight, kPeriod_ns}, cursor_, clocks_, log_, memory);
  EXPECT_EQ(source.start().code(), StatusCode::kOutOfMemory);
}

TEST_F(ReplayImageTest, ImpossibleOptions_AreRefused) {
  ASSERT_TRUE(cursor_.open(path(), 0).ok());
  for (const ReplayImageOptions& options :
       {ReplayImageOptions{"cam0", 0, kHeight, kPeriod_ns}, ReplayImageOptions{"cam0", kWidth, -1, kPeriod_ns},
        ReplayImageOptions{"cam0", kWidth, kHeight, 0}}) {
    ReplayImageSource source(options, cursor_, clocks_, log_, {});
    EXPECT_EQ(source.start().code(), StatusCode::kUnsupported);
  }
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(source_->next(0, MutableImageView(pixels_.data(), 1, 1, 8), facts_).code(), StatusCode::kInvalidArgument);
}

TEST_F(ReplayImageTest, Stopped_GivesNothingUntilStarted) {
  ASSERT_TRUE(start().ok());
  source_->stop();
  EXPECT_EQ(source_->health().state, SourceState::kClosed);
  EXPECT_EQ(next(kPeriod_ns).code(), StatusCode::kUnavailable);
  ASSERT_TRUE(source_->start().ok());
  EXPECT_TRUE(next().ok());
  EXPECT_EQ(facts_.sequence, 0U);
}

}  // namespace
}  // namespace roomcal::drivers
