#include "drivers/image/health_log.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

using ports::ImageFault;

constexpr int64_t kS = 1'000'000'000;

struct Lines final : ports::Log {
  void note(std::string_view who, std::string_view what) override {
    lines.push_back(std::string(who) + ": " + std::string(what));
  }
  std::vector<std::string> lines;
};

TEST(HealthLog, FaultAThousandTimes_IsCountedAndToldOnce) {
  Lines lines;
  HealthLog log("cam2", lines);
  log.start();
  for (int i = 0; i < 1000; ++i) {
    log.fault(ImageFault::kShort, i * kS / 100);
    log.image(0, i * kS / 100);
  }
  EXPECT_EQ(log.health().faults[static_cast<std::size_t>(ImageFault::kShort)], 1000U);
  ASSERT_EQ(lines.lines.size(), 1U);
  EXPECT_EQ(lines.lines[0], "cam2: short image; check the cable and the network's packet size");
}

TEST(HealthLog, QuietSpell_IsToldWithTheCountAndTheNextFaultAgain) {
  Lines lines;
  HealthLog log("cam0", lines);
  log.start();
  log.fault(ImageFault::kGone, 0, 19);
  log.fault(ImageFault::kStall, kS);
  log.fault(ImageFault::kStall, 2 * kS);
  for (uint64_t i = 0; i < HealthLog::kQuietImages; ++i) log.image(0, 11 * kS);  // quiet of one, not yet of the other
  ASSERT_EQ(lines.lines.size(), 3U);
  EXPECT_EQ(lines.lines[0], "cam0: unplugged; plug it in again (errno 19)");
  EXPECT_EQ(lines.lines[2], "cam0: over: unplugged, 1 time");
  log.image(0, 12 * kS);
  ASSERT_EQ(lines.lines.size(), 4U);
  EXPECT_EQ(lines.lines[3], "cam0: over: no images, 2 times");
  log.fault(ImageFault::kStall, 13 * kS);
  EXPECT_EQ(lines.lines.size(), 5U);
}

TEST(HealthLog, FewImagesInALongTime_AreNoHealth) {
  Lines lines;
  HealthLog log("cam0", lines);
  log.start();
  for (int i = 0; i < 10; ++i) {
    log.fault(ImageFault::kGone, i * 60 * kS);
    for (uint64_t n = 0; n + 1 < HealthLog::kQuietImages; ++n) log.image(0, i * 60 * kS + 30 * kS);
  }
  EXPECT_EQ(lines.lines.size(), 1U);
}

TEST(HealthLog, NoImages_AreNoHealth) {
  Lines lines;
  HealthLog log("cam0", lines);
  log.start();
  for (int i = 0; i < 100; ++i) log.fault(ImageFault::kNotFound, i * 60 * kS);
  EXPECT_EQ(lines.lines.size(), 1U);
}

TEST(HealthLog, DistinctFaults_HaveALineEach) {
  Lines lines;
  HealthLog log("cam0", lines);
  log.start();
  for (int n = 0; n < 3; ++n)
    for (std::size_t i = 0; i < ports::kImageFaults; ++i) log.fault(static_cast<ImageFault>(i), n, static_cast<int>(i));
  EXPECT_EQ(lines.lines.size(), ports::kImageFaults);
  EXPECT_EQ(log.health().last_fault, ImageFault::kGone);
  log.fault(ImageFault::kCount, 5);  // none
  EXPECT_EQ(log.health().last_fault, ImageFault::kGone);
}

TEST(HealthLog, StepsAndImages_AreCountedAndGivingUpIsToldOnce) {
  Lines lines;
  HealthLog log("cam0", lines);
  log.start();
  log.image(3, 1);
  log.image(4, 2);
  log.superseded();
  log.state(ports::SourceState::kFaulted);
  log.fault(ImageFault::kStall, 3);
  for (const RecoveryStep step : {RecoveryStep::kRestartStream, RecoveryStep::kRestartStream, RecoveryStep::kReopen,
                                  RecoveryStep::kResetPort, RecoveryStep::kGiveUp, RecoveryStep::kGiveUp})
    log.step(step);
  const ports::ImageHealth& health = log.health();
  EXPECT_EQ(health.images, 2U);
  EXPECT_EQ(health.lost, 7U);
  EXPECT_EQ(health.superseded, 1U);
  EXPECT_EQ(health.restarts, 2U);
  EXPECT_EQ(health.reopens, 1U);
  EXPECT_EQ(health.port_resets, 1U);
  EXPECT_EQ(health.state, ports::SourceState::kFaulted);
  ASSERT_EQ(lines.lines.size(), 2U);
  EXPECT_EQ(lines.lines[1], "cam0: given up after 2 restarts and 1 reopens: no images; check cable, trigger and power");
  log.start();
  EXPECT_EQ(log.health().images, 0U);
  EXPECT_EQ(log.health().last_fault, ImageFault::kCount);
}

TEST(HealthLog, NoteOnce_IsWrittenOnceSinceTheStart) {
  Lines lines;
  HealthLog log("cam0", lines);
  log.start();
  for (const char* what : {"gain", "rate", "gain", "rate"}) log.note_once(what);
  EXPECT_EQ(lines.lines, (std::vector<std::string>{"cam0: gain", "cam0: rate"}));
  for (int i = 0; i < 1000; ++i) log.note_once(std::to_string(i));
  EXPECT_EQ(lines.lines.size(), 16U);
  log.start();
  log.note_once("gain");
  log.note("gain");
  EXPECT_EQ(lines.lines.size(), 18U);
}

}  // namespace
}  // namespace roomcal::drivers
