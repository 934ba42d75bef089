#include "drivers/relay/relay_source.h"

#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "drivers/relay/software_trigger.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/relay/scripted_camera.h"
#include "tests/fakes/log_lines.h"

namespace roomcal::drivers {
namespace {

using ports::ImageFault;
using ports::SourceState;

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kLongMs = 5'000;

class RelaySourceTest : public testing::Test {
 protected:
  RelaySourceTest() {
    options_.recovery.stall_ns = 100 * kMs;
    options_.recovery.first_image_ns = 100 * kMs;
    options_.recovery.shortest_wait_ns = options_.recovery.longest_wait_ns = 20 * kMs;
    options_.start_wait_ns = options_.stop_wait_ns = 5000 * kMs;
  }

  std::unique_ptr<RelaySource> make() {
    return std::make_unique<RelaySource>("cam1", options_, std::make_unique<ScriptedCamera>(script_), clocks_, log_);
  }
  std::unique_ptr<RelaySource> make_started() {
    auto source = make();
    EXPECT_TRUE(source->start().ok());
    return source;
  }
  // Everything a test waits for happens in some other thread.
  static bool eventually(const std::function<bool()>& holds) {
    for (int i = 0; i < kLongMs; ++i) {
      if (holds()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  Status next(RelaySource& source, int64_t wait_ms = kLongMs) {
    return source.next(wait_ms * kMs, {pixels_.data(), Script::kWidth, Script::kHeight}, facts_);
  }
  static uint32_t faults(const RelaySource& source, ImageFault fault) {
    return source.health().faults[static_cast<std::size_t>(fault)];
  }

  RelayOptions options_;
  LinuxClocks clocks_;
  fakes::LogLines log_;
  Script script_;
  std::array<uint8_t, Script::kWidth * Script::kHeight> pixels_{};
  ports::ImageFacts facts_;
};

TEST_F(RelaySourceTest, Images_ComeWithNumbersFromZeroAndLosses) {
  auto source = make_started();
  ASSERT_TRUE(script_.image(700, 10));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_EQ(pixels_[5], 10);
  EXPECT_EQ(facts_.sequence, 0U);
  EXPECT_TRUE(facts_.first_after_gap);
  ASSERT_TRUE(script_.image(703, 11));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_EQ(pixels_[5], 11);
  EXPECT_EQ(facts_.sequence, 3U);
  EXPECT_EQ(facts_.lost_before, 2U);
  EXPECT_EQ(source->health().images, 2U);
  EXPECT_EQ(source->health().lost, 2U);
  EXPECT_EQ(source->health().state, SourceState::kStreaming);
  EXPECT_TRUE(log_.lines().empty());
}

TEST_F(RelaySourceTest, SlowReader_GetsTheNewestAndTheLibraryItsBuffers) {
  auto source = make_started();
  for (uint32_t i = 0; i < 100; ++i) {
    ASSERT_TRUE(eventually([&] { return script_.image(2 * i, static_cast<uint8_t>(i)); }));
  }
  ASSERT_TRUE(eventually([&] { return script_.slots_with_library() == Script::kSlots - 1; }));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_EQ(pixels_[0], 99);
  EXPECT_EQ(facts_.sequence, 198U);
  EXPECT_EQ(facts_.lost_before, 99U);
  EXPECT_EQ(source->health().superseded, 99U);
  EXPECT_TRUE(eventually([&] { return script_.slots_with_library() == Script::kSlots; }));
}

TEST_F(RelaySourceTest, NoImage_IsUnavailableAfterTheWait) {
  auto source = make_started();
  const int64_t began_ns = clocks_.now_ns();
  EXPECT_EQ(next(*source, 30).code(), StatusCode::kUnavailable);
  EXPECT_GE(clocks_.now_ns() - began_ns, 30 * kMs);
  EXPECT_LT(clocks_.now_ns() - began_ns, 1000 * kMs);
}

TEST_F(RelaySourceTest, OtherSize_IsRefusedAndTheBufferGoesBack) {
  auto source = make_started();
  ASSERT_TRUE(script_.image(0, 0));
  std::array<uint8_t, 4> small{};
  EXPECT_EQ(source->next(kLongMs * kMs, {small.data(), 2, 2}, facts_).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(source->health().images, 0U);
  EXPECT_TRUE(eventually([&] { return script_.slots_with_library() == Script::kSlots; }));
}

TEST_F(RelaySourceTest, Next_TakesNoHeap) {
  auto source = make_started();
  for (uint32_t i = 0; i < 20; ++i) {
    ASSERT_TRUE(eventually([&] { return script_.image(i, 1); }));
    budget::HeapGuard guard;
    const Status got = next(*source);
    const std::size_t calls = guard.calls();
    EXPECT_TRUE(got.ok());
    EXPECT_EQ(calls, 0U);
  }
  budget::HeapGuard guard;
  const Status none = next(*source, 300);  // stalls meanwhile
  EXPECT_EQ(guard.calls(), 0U);
  EXPECT_FALSE(none.ok());
}

TEST_F(RelaySourceTest, DamagedBuffers_AreCountedToldOnceAndRestartTheStream) {
  auto source = make_started();
  ASSERT_TRUE(script_.image(0, 0));
  ASSERT_TRUE(next(*source).ok());
  for (uint32_t i = 1; i <= 3; ++i) {
    ASSERT_TRUE(script_.image(i, 0, ImageFault::kShort));
    ASSERT_TRUE(eventually([&] { return script_.slots_with_library() == Script::kSlots; }));
  }
  ASSERT_TRUE(eventually([&] { return script_.restarted() == 1; }));
  ASSERT_TRUE(script_.image(4, 0));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_EQ(faults(*source, ImageFault::kShort), 3U);
  EXPECT_EQ(source->health().restarts, 1U);
  EXPECT_EQ(log_.count("short image"), 1U);
}

TEST_F(RelaySourceTest, StampThatCannotBe_IsNamedAndTheImageComes) {
  auto source = make_started();
  ASSERT_TRUE(script_.image_stamped(0, {clocks_.now_ns() + 37'000 * kMs, ClockId::kMonotonic}));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_EQ(faults(*source, ImageFault::kStampTai), 1U);
  EXPECT_EQ(facts_.exposed, (Stamp{facts_.arrived_ns - facts_.uncertainty_ns, ClockId::kMonotonic}));
  EXPECT_EQ(log_.count("37 s ahead"), 1U);
}

TEST_F(RelaySourceTest, StampOfTheCamerasOwnClock_IsLeftAsItIs) {
  auto source = make_started();
  for (uint32_t i = 0; i < 3; ++i) {
    const Stamp stamp{1'000'000'000 + 40 * kMs * i, ClockId::kDevice};
    ASSERT_TRUE(script_.image_stamped(i, stamp));
    ASSERT_TRUE(next(*source).ok());
    EXPECT_EQ(facts_.exposed, stamp);
  }
  EXPECT_TRUE(log_.lines().empty());
}

TEST_F(RelaySourceTest, Stall_RestartsThenReopensThenGivesUp) {
  auto source = make_started();
  while (next(*source, 50).code() == StatusCode::kUnavailable && source->health().state != SourceState::kFaulted) {
  }
  EXPECT_EQ(script_.restarted(), 2);
  EXPECT_EQ(script_.opened(), 3);
  EXPECT_EQ(script_.closed(), 3);
  EXPECT_EQ(source->health().restarts, 2U);
  EXPECT_EQ(source->health().reopens, 2U);
  EXPECT_EQ(log_.count("given up after 2 restarts and 2 reopens"), 1U);
  EXPECT_STREQ(next(*source, 0).detail(), "no image: the camera has been given up, see its log");
  ASSERT_TRUE(source->start().ok());
  ASSERT_TRUE(script_.image(0, 0));
  EXPECT_TRUE(next(*source).ok());
}

TEST_F(RelaySourceTest, NobodyAsks_NoStall) {
  auto source = make_started();
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  ASSERT_TRUE(script_.image(0, 0));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_EQ(script_.restarted(), 0);
}

TEST_F(RelaySourceTest, UnpluggedCamera_IsLookedForUntilItIsBack) {
  auto source = make_started();
  ASSERT_TRUE(script_.image(0, 0));
  ASSERT_TRUE(next(*source).ok());
  const LibraryResult nobody(ImageFault::kNotFound);
  script_.on_open({nobody, nobody, nobody, nobody, nobody});
  script_.on_diagnose(ImageFault::kGone);
  while (script_.opened() < 7) EXPECT_FALSE(next(*source, 20).ok());
  EXPECT_EQ(script_.restarted(), 0);
  ASSERT_TRUE(eventually([&] { return script_.image(5, 3); }));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_TRUE(facts_.first_after_gap);
  EXPECT_EQ(facts_.lost_before, 0U);
  EXPECT_EQ(source->health().state, SourceState::kStreaming);
  EXPECT_EQ(faults(*source, ImageFault::kNotFound), 5U);
  EXPECT_EQ(log_.count("unplugged"), 1U);
}

TEST_F(RelaySourceTest, LookingAfter_FindsWhatImagesDoNotTell) {
  auto source = make_started();
  ASSERT_TRUE(script_.image(0, 0));
  script_.on_look_after(ImageFault::kStale);
  EXPECT_TRUE(eventually([&] { return script_.opened() == 2; }));
}

TEST_F(RelaySourceTest, CameraMissingAtTheStart_IsNotFoundAndComesLater) {
  script_.on_open({LibraryResult(ImageFault::kNotFound)});
  auto source = make();
  EXPECT_EQ(source->start().code(), StatusCode::kNotFound);
  ASSERT_TRUE(eventually([&] { return script_.image(0, 0); }));
  EXPECT_TRUE(next(*source).ok());
}

TEST_F(RelaySourceTest, WrongFormat_IsGivenUp) {
  script_.on_open({LibraryResult(ImageFault::kFormat)});
  auto source = make();
  EXPECT_EQ(source->start().code(), StatusCode::kUnsupported);
  EXPECT_EQ(next(*source, 50).code(), StatusCode::kUnavailable);
  EXPECT_EQ(source->health().state, SourceState::kFaulted);
  EXPECT_EQ(script_.opened(), 1);
}

TEST_F(RelaySourceTest, LibraryThatHangsInOpen_HoldsNobodyUp) {
  options_.start_wait_ns = 50 * kMs;
  options_.hang_ns = 80 * kMs;
  script_.hang_in("open");
  auto source = make();
  const int64_t began_ns = clocks_.now_ns();
  EXPECT_EQ(source->start().code(), StatusCode::kUnavailable);
  EXPECT_EQ(next(*source, 100).code(), StatusCode::kUnavailable);
  EXPECT_EQ(next(*source, 0).code(), StatusCode::kUnavailable);
  EXPECT_LT(clocks_.now_ns() - began_ns, 1000 * kMs);
  EXPECT_EQ(source->health().state, SourceState::kFaulted);
  EXPECT_EQ(log_.count("Script does not return"), 1U);
  script_.release();
  ASSERT_TRUE(eventually([&] { return script_.image(0, 0); }));
  EXPECT_TRUE(next(*source).ok());
  EXPECT_EQ(source->health().state, SourceState::kStreaming);
}

TEST_F(RelaySourceTest, LibraryThatHangsInClose_IsLeftBehind) {
  // Its thread outlives the test, and with it what it uses.
  static Script& hanging = *new Script;
  static fakes::LogLines& log = *new fakes::LogLines;
  static const LinuxClocks clocks;
  options_.stop_wait_ns = 50 * kMs;
  RelaySource source("cam1", options_, std::make_unique<ScriptedCamera>(hanging), clocks, log);
  ASSERT_TRUE(source.start().ok());
  hanging.hang_in("close");
  const int64_t began_ns = clocks_.now_ns();
  source.stop();
  EXPECT_LT(clocks_.now_ns() - began_ns, 1000 * kMs);
  EXPECT_EQ(source.health().state, SourceState::kFaulted);
  EXPECT_EQ(source.start().code(), StatusCode::kUnavailable);
  EXPECT_EQ(log.count("left behind"), 1U);
}

TEST_F(RelaySourceTest, StopAndStart_BeginAnew) {
  auto source = make_started();
  ASSERT_TRUE(script_.image(0, 0));
  ASSERT_TRUE(next(*source).ok());
  ASSERT_TRUE(script_.image(1, 0));
  source->stop();
  EXPECT_EQ(source->health().state, SourceState::kClosed);
  EXPECT_EQ(next(*source, 0).code(), StatusCode::kUnavailable);
  ASSERT_TRUE(source->start().ok());
  EXPECT_EQ(source->health().images, 0U);
  EXPECT_EQ(next(*source, 10).code(), StatusCode::kUnavailable) << "an image of before";
  ASSERT_TRUE(script_.image(7, 0));
  ASSERT_TRUE(next(*source).ok());
  EXPECT_EQ(facts_.sequence, 0U);
}

class SoftwareTriggerTest : public RelaySourceTest {
 protected:
  SoftwareTriggerTest() {
    script_.free_running = other_script_.free_running = false;
    EXPECT_TRUE(trigger_.add(one_).ok());
    EXPECT_TRUE(trigger_.add(other_).ok());
  }

  Script other_script_;
  RelaySource one_{"cam0", options_, std::make_unique<ScriptedCamera>(script_), clocks_, log_};
  RelaySource other_{"cam1", options_, std::make_unique<ScriptedCamera>(other_script_), clocks_, log_};
  SoftwareTrigger trigger_{clocks_};
};

TEST_F(SoftwareTriggerTest, Fire_TellsEveryCameraOnceAndWithoutHeap) {
  ASSERT_TRUE(one_.start().ok());
  ASSERT_TRUE(other_.start().ok());
  budget::HeapGuard guard;
  const Status fired = trigger_.fire();
  const std::size_t calls = guard.calls();
  EXPECT_TRUE(fired.ok());
  EXPECT_EQ(calls, 0U);
  EXPECT_EQ(script_.fired(), 1);
  EXPECT_EQ(other_script_.fired(), 1);
}

TEST_F(SoftwareTriggerTest, WaitingForATrigger_IsNoStallButForItsImageIs) {
  ASSERT_TRUE(one_.start().ok());
  ASSERT_TRUE(other_.start().ok());
  EXPECT_FALSE(next(one_, 400).ok());
  EXPECT_EQ(script_.restarted(), 0);
  EXPECT_EQ(one_.health().state, SourceState::kStreaming);
  ASSERT_TRUE(trigger_.fire().ok());
  ASSERT_TRUE(other_script_.image(0, 0));
  EXPECT_TRUE(eventually([&] { return script_.restarted() == 1; }));
  EXPECT_EQ(other_script_.restarted(), 0);
}

TEST_F(SoftwareTriggerTest, CameraThatDoesNotStream_MeansNobodyIsTold) {
  ASSERT_TRUE(one_.start().ok());
  EXPECT_EQ(trigger_.fire().code(), StatusCode::kUnavailable);
  EXPECT_EQ(script_.fired(), 0);
}

TEST_F(SoftwareTriggerTest, CameraThatRefuses_IsAnError) {
  ASSERT_TRUE(one_.start().ok());
  ASSERT_TRUE(other_.start().ok());
  other_script_.on_fire(false);
  EXPECT_EQ(trigger_.fire().code(), StatusCode::kUnavailable);
}

TEST_F(SoftwareTriggerTest, NoCameras_FireNothing) {
  SoftwareTrigger none(clocks_);
  EXPECT_EQ(none.fire().code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace roomcal::drivers
