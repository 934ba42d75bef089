// One press from standing still to the store, and everything that can end it on the way.
#include "runtime/press/press.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "tests/runtime/press/press_bench.h"

namespace roomcal::press {
namespace {

using test::PressBench;

bool passed(const Report& report) { return report.result == Result::kPass || report.result == Result::kPassAdvise; }

TEST(Press, Calibrate_IsStoredAndTellsWhatItDid) {
  PressBench bench;
  std::set<State> states;
  int percent = 0;
  bench.on_images = [&] {
    const Moment now = bench.session().now();
    states.insert(now.state);
    EXPECT_GE(now.percent, percent);
    percent = now.percent;
  };
  const std::string reasons = bench.press(Kind::kCalibrate);
  const Report& report = bench.report();
  ASSERT_TRUE(passed(report)) << to_string(report.result) << "\n" << reasons;
  EXPECT_EQ(report.trouble, Trouble::kNone);
  EXPECT_TRUE(report.stored);
  EXPECT_EQ(report.kind, Kind::kCalibrate);
  EXPECT_EQ(report.tries, 1U);
  EXPECT_EQ(report.measured_unix_s, 1'700'000'001);
  EXPECT_GE(report.total_ns, report.grab_ns);
  EXPECT_EQ(states, std::set<State>{State::kGrab});

  const store::Record* record = bench.store.current();
  ASSERT_NE(record, nullptr);
  EXPECT_EQ(report.generation, record->generation);
  EXPECT_EQ(record->device_serial.view(), "RB-1");
  EXPECT_EQ(record->firmware_id.view(), "roomcald test");
  EXPECT_EQ(record->map_hash, test::seen_room().map.map.content_crc32c());
  ASSERT_EQ(record->sensors.size(), 2U);
  EXPECT_EQ(record->sensors[1].serial.view(), "S-1");
  EXPECT_EQ(record->sensors[1].T_rig_sensor.t, bench.session().outcome().cameras[1].T_rig_cam.t);
}

TEST(Press, VerifyAndDryRun_WriteNothing) {
  PressBench bench;
  for (const Kind kind : {Kind::kVerify, Kind::kDryRun}) {
    const std::string reasons = bench.press(kind);
    EXPECT_TRUE(passed(bench.report())) << reasons;
    EXPECT_FALSE(bench.report().stored);
    EXPECT_FALSE(bench.session().outcome().installed.done) << "there is nothing to compare with";
  }
  EXPECT_TRUE(bench.medium.trace().empty());
  EXPECT_EQ(bench.store.state(), store::State::kUncalibrated);
}

TEST(Press, VerifyAfterwards_FindsEverythingWhereItWas) {
  PressBench bench;
  bench.press(Kind::kCalibrate);
  bench.medium.set_script({});
  bench.press(Kind::kVerify);
  EXPECT_TRUE(passed(bench.report()));
  EXPECT_TRUE(bench.session().outcome().installed.done);
  EXPECT_FALSE(bench.session().outcome().installed.moved);
  EXPECT_TRUE(bench.medium.trace().empty());
}

// Between the button and the session's thread lie some milliseconds.
TEST(Press, AbortBeforeTheThreadHasBegun_Counts) {
  PressBench bench;
  bench.session().begin();
  EXPECT_EQ(bench.session().now().state, State::kWaitStill) << "store and report are no longer free";
  bench.session().abort();
  bench.session().run(Kind::kCalibrate);
  EXPECT_EQ(bench.report().result, Result::kAborted);
  EXPECT_EQ(bench.reasons(), "stopped by the operator: nothing was stored\n");
  EXPECT_EQ(bench.store.state(), store::State::kUncalibrated);
  bench.press(Kind::kCalibrate);
  EXPECT_TRUE(bench.report().stored) << "the abort was of the press before";
}

TEST(Press, AbortAtAnyMomentOfTheGrab_StoresNothing) {
  int ended = 0;
  for (int at = 0;; ++at) {
    PressBench bench;
    int images = 0;
    bench.on_images = [&] {
      if (images++ == at) bench.session().abort();
    };
    bench.press(Kind::kCalibrate);
    if (bench.report().stored) break;
    EXPECT_EQ(bench.report().result, Result::kAborted);
    EXPECT_EQ(bench.report().trouble, Trouble::kNone);
    EXPECT_EQ(bench.store.state(), store::State::kUncalibrated);
    ++ended;
  }
  EXPECT_GE(ended, 5);
}

// What the store says must be so, whichever write, sync or read of the commit fails: the new record or the old one is
// in force, and the report says which.
TEST(Press, MediumThatFailsOnce_NeverLeavesADoubt) {
  PressBench bench;
  bench.press(Kind::kCalibrate);
  const uint64_t first = bench.store.current()->generation;
  const fakes::Image before = bench.medium.durable();
  std::size_t writes = 0, syncs = 0, reads = 0;
  const auto try_with = [&](const fakes::MediumScript& script) {
    bench.medium.set_durable(before);
    bench.medium.power_on();
    bench.store.load();
    bench.medium.set_script(script);
    bench.press(Kind::kCalibrate);
    const Report report = bench.report();
    writes = bench.medium.writes(), syncs = bench.medium.syncs(), reads = bench.medium.reads();
    bench.medium.power_on();
    bench.store.load();
    EXPECT_NE(bench.store.current(), nullptr);
    if (bench.store.current() == nullptr) return report;
    const bool is_new = bench.store.current()->content_generation > first;
    EXPECT_EQ(report.stored, is_new) << bench.reasons();
    EXPECT_EQ(report.result, report.stored ? report.result : Result::kFailService);
    EXPECT_TRUE(report.stored || report.trouble == Trouble::kStore);
    return report;
  };
  EXPECT_TRUE(try_with({}).stored);
  const std::size_t all_writes = writes, all_syncs = syncs, all_reads = reads;
  std::size_t failed = 0;
  const auto each = [&](std::size_t count, std::size_t stride, std::size_t fakes::MediumScript::*which) {
    for (std::size_t i = 0; i < count; i += stride) {
      fakes::MediumScript script;
      script.*which = i;
      failed += try_with(script).stored ? 0 : 1;
    }
  };
  each(all_writes, all_writes / 8 + 1, &fakes::MediumScript::fail_write);
  each(all_writes, all_writes / 8 + 1, &fakes::MediumScript::flip_write);
  each(all_syncs, 1, &fakes::MediumScript::fail_sync);
  each(all_reads, all_reads / 12 + 1, &fakes::MediumScript::fail_read);
  EXPECT_GE(failed, 8U);
}

TEST(Press, MediumThatTakesNothing_IsFailServiceAndTheOldRecordStays) {
  PressBench bench;
  bench.press(Kind::kCalibrate);
  const uint64_t generation = bench.store.current()->generation;
  bench.medium.set_script({.fail_write = 0, .from_then_on = true});
  const std::string reasons = bench.press(Kind::kCalibrate);
  EXPECT_EQ(bench.report().result, Result::kFailService);
  EXPECT_EQ(bench.report().trouble, Trouble::kStore);
  EXPECT_NE(reasons.find("store: "), std::string::npos) << reasons;
  ASSERT_NE(bench.store.current(), nullptr);
  EXPECT_EQ(bench.store.current()->generation, generation);
}

TEST(Press, RoomWithoutLight_IsFailRetryForTheImages) {
  PressBench bench;
  for (cv::Mat& image : bench.images) image = image * 0.02;
  const std::string reasons = bench.press(Kind::kCalibrate);
  EXPECT_EQ(bench.report().result, Result::kFailRetry);
  EXPECT_TRUE(bench.report().trouble == Trouble::kImages || bench.report().trouble == Trouble::kMotion) << reasons;
  EXPECT_NE(reasons, "");
  EXPECT_EQ(bench.store.state(), store::State::kUncalibrated);
}

TEST(Press, NoCameraDelivers_IsFailRetryForTheImages) {
  PressBench bench;
  bench.images.assign(2, cv::Mat());
  const std::string reasons = bench.press(Kind::kCalibrate);
  EXPECT_EQ(bench.report().result, Result::kFailRetry);
  EXPECT_EQ(bench.report().trouble, Trouble::kImages);
  EXPECT_NE(reasons.find("no camera delivers"), std::string::npos) << reasons;
  EXPECT_FALSE(bench.session().has_outcome());
}

TEST(Press, DeviceThatMoves_IsFailRetryForTheMotion) {
  PressBench bench;
  int shown = 0;
  bench.on_images = [&] {
    ++shown;
    for (std::size_t i = 0; i < bench.images.size(); ++i) {
      const cv::Mat& still = test::seen_room().images[i];
      const int shift = 3 * (shown % 40);
      bench.images[i] = cv::Mat(still.size(), CV_8UC1, cv::Scalar(100));
      still.colRange(shift, still.cols).copyTo(bench.images[i].colRange(0, still.cols - shift));
    }
  };
  const std::string reasons = bench.press(Kind::kCalibrate);
  EXPECT_EQ(bench.report().result, Result::kFailRetry) << reasons;
  EXPECT_EQ(bench.report().trouble, Trouble::kMotion) << reasons;
}

// NTP sets the host's clock, on which the cameras stamp, at any moment of the grab: one image is off by what it was
// set, or the exposures are taken again; the record has the time that holds now.
TEST(Press, ClockThatStepsDuringTheGrab_IsStoredAllTheSameOrTriedAgain) {
  constexpr int64_t kHour_ns = 3'600'000'000'000, kMs = 1'000'000;
  int stepped = 0;
  for (const int64_t step_ns : {kHour_ns, -kHour_ns})
    for (int at = 1; at <= 12; at += 2) {
      PressBench bench(20 * kMs);
      bench.stamps = ClockId::kRealtime;
      int images = 0;
      bench.on_images = [&] {
        if (++images != at) return;
        bench.clocks.step_realtime(step_ns);
        ++stepped;
      };
      const std::string reasons = bench.press(Kind::kCalibrate);
      ASSERT_TRUE(bench.report().stored) << "step at " << at << ": " << reasons;
      EXPECT_LE(bench.report().tries, 2U);
      EXPECT_LT(bench.report().spread_ns, 20 * kMs + 2 * bench.report().spread_uncertainty_ns);
      EXPECT_EQ(bench.report().measured_unix_s, bench.clocks.read(ClockId::kRealtime).ns / 1'000'000'000);
    }
  EXPECT_GE(stepped, 8);
}

struct FixedThermometer final : ports::Thermometer {
  double read_c() override { return degrees_c; }
  double degrees_c = 41.25;
};

TEST(Press, Circumstances_AreInTheRecord) {
  FixedThermometer thermometer;
  PressBench bench(0, &thermometer);
  bench.press(Kind::kCalibrate);
  ASSERT_TRUE(bench.report().stored) << bench.reasons();
  EXPECT_EQ(bench.store.current()->temperature_c, 41.25);
  EXPECT_EQ(bench.store.current()->trigger.view(), "line");
  thermometer.degrees_c = std::numeric_limits<double>::quiet_NaN();
  bench.press(Kind::kCalibrate);
  ASSERT_TRUE(bench.report().stored) << bench.reasons();
  EXPECT_TRUE(std::isnan(bench.store.current()->temperature_c)) << "the record of before is no measurement";
}

TEST(Press, HostThatDoesNotKnowTheTime_StoresNone) {
  PressBench bench;
  bench.clocks.step_realtime(-1'690'000'000'000'000'000);
  bench.press(Kind::kCalibrate);
  ASSERT_TRUE(bench.report().stored) << bench.reasons();
  EXPECT_EQ(bench.report().measured_unix_s, 0);
  EXPECT_EQ(bench.store.current()->written_unix_s, 0);
}

}  // namespace
}  // namespace roomcal::press
