#include "runtime/grab/grabber.h"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fakes/manual_clocks.h"
#include "tests/truth/random.h"

namespace roomcal::grab {
namespace {

constexpr int64_t kMs = 1'000'000;
constexpr int kWidth = 320, kHeight = 240;

struct ScriptedStillness final : ports::StillnessSensor {
  ports::Stillness look(int64_t now_ns) override {
    if (now_ns < still_from_ns || now_ns >= still_until_ns) return {false, "can0: the vehicle moves: stop it"};
    return {true, {}};
  }
  int64_t still_from_ns = 0, still_until_ns = INT64_MAX;
};

struct Watcher final : GrabWatcher {
  bool waiting(GrabStep /*step*/, const Reason& why) override {
    last = std::string(why.view());
    return patience-- > 0;
  }
  std::string last;
  int patience = 100'000;
};

/// Cameras that run free in a world that moves by `shift_px` at a time.
class GrabberTest : public testing::Test, public ports::Trigger {
 protected:
  static constexpr std::size_t kCameras = 2;

  GrabberTest() {
    options_.patience_ns = 3'000 * kMs;
    for (std::size_t i = 0; i < kCameras; ++i) {
      memory_.emplace_back(ImageRing::bytes(kWidth, kHeight, 2));
      rings_.push_back(std::make_unique<ImageRing>());
      Arena arena(memory_.back());
      EXPECT_TRUE(rings_.back()->create(kWidth, kHeight, 2, arena).ok());
      EXPECT_TRUE(sources_.cameras.push_back({i == 0 ? "cam0" : "cam1", rings_.back().get()}));
    }
    clocks_.on_sleep = [this](int64_t now_ns) { live(now_ns); };
  }

  const char* name() const override { return "line"; }
  Status fire() override {
    ++fired_;
    return trigger_status_;
  }

  void live(int64_t now_ns) {
    for (std::size_t i = 0; i < kCameras; ++i) {
      const int64_t phase_ns = static_cast<int64_t>(i) * apart_ns_;
      while (delivers_[i] && next_ns_[i] + phase_ns <= now_ns) {
        take(i, next_ns_[i] + phase_ns);
        next_ns_[i] += 33 * kMs;
      }
    }
  }
  void take(std::size_t i, int64_t exposed_ns) {
    const MutableImageView place = rings_[i]->begin_write();
    if (place.empty()) return;
    const double shift = exposed_ns >= moves_at_ns_ ? shift_px_ : 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        place(x, y) = static_cast<uint8_t>(
            textured_ ? 120 + 60 * std::sin((x - shift) / 4.1) * std::cos(y / 3.7) + random_.normal() : 120);
    rings_[i]->publish({}, {exposed_ns, 1 * kMs});
  }
  Grabber& grabber() {
    if (!grabber_) grabber_ = std::make_unique<Grabber>(sources_, options_, clocks_);
    return *grabber_;
  }
  Status grab() { return grabber().grab(watcher_, shot_); }
  std::string reason() { return std::string(grabber().reason().view()); }

  fakes::ManualClocks clocks_;
  truth::Random random_{1};
  std::vector<std::vector<std::byte>> memory_;
  std::vector<std::unique_ptr<ImageRing>> rings_;
  Sources sources_;
  GrabOptions options_;
  Watcher watcher_;
  Grabbed shot_;
  ScriptedStillness vehicle_;
  Status trigger_status_;
  std::unique_ptr<Grabber> grabber_;
  bool delivers_[kCameras] = {true, true};
  int64_t next_ns_[kCameras] = {1'000 * kMs, 1'000 * kMs};
  int64_t apart_ns_ = 10 * kMs;
  int64_t moves_at_ns_ = INT64_MAX;
  double shift_px_ = 1;
  bool textured_ = true;
  int fired_ = 0;
};

TEST_F(GrabberTest, DeviceThatStands_GivesOneShotWithItsSpread) {
  const int64_t pressed_ns = clocks_.now_ns();
  ASSERT_TRUE(grab().ok()) << reason();
  EXPECT_EQ(shot_.tries, 1U);
  ASSERT_EQ(shot_.images.size(), kCameras);
  EXPECT_FALSE(shot_.images[0].empty());
  EXPECT_FALSE(shot_.images[1].empty());
  EXPECT_GE(shot_.begin_ns, pressed_ns);
  EXPECT_GE(shot_.held[0].time.exposed_ns - shot_.begin_ns, options_.dwell_ns);
  EXPECT_NEAR(static_cast<double>(shot_.spread_ns), 10.0 * kMs, 23.0 * kMs);
  EXPECT_EQ(shot_.uncertainty_ns, 1 * kMs);
  EXPECT_LT(clocks_.now_ns() - pressed_ns, 400 * kMs);
  EXPECT_TRUE(shot_.notes.empty());
  grabber().release(shot_);
  EXPECT_EQ(rings_[0]->hold_since(0).size(), 1U) << "everything was given back";
}

TEST_F(GrabberTest, MovedBetweenTheImages_IsTriedAgain) {
  moves_at_ns_ = clocks_.now_ns() + 150 * kMs;
  ASSERT_TRUE(grab().ok()) << reason();
  EXPECT_EQ(shot_.tries, 2U);
}

TEST_F(GrabberTest, NeverStill_GivesUpWithTheVehiclesReason) {
  vehicle_.still_until_ns = 0;
  ASSERT_TRUE(sources_.stillness.push_back(&vehicle_));
  EXPECT_EQ(grab().code(), StatusCode::kUnavailable);
  EXPECT_EQ(reason(), "can0: the vehicle moves: stop it");
  EXPECT_LT(clocks_.now_ns(), 4'200 * kMs);
  EXPECT_EQ(rings_[0]->hold_since(0).size(), 1U);
}

TEST_F(GrabberTest, VehicleThatStopsLate_IsWaitedForAndMustHaveStoodForAWhile) {
  vehicle_.still_from_ns = clocks_.now_ns() + 500 * kMs;
  ASSERT_TRUE(sources_.stillness.push_back(&vehicle_));
  ASSERT_TRUE(grab().ok()) << reason();
  EXPECT_GE(shot_.begin_ns, vehicle_.still_from_ns + options_.still_for_ns);
}

TEST_F(GrabberTest, VehicleThatStartsDuringTheShot_SpoilsIt) {
  vehicle_.still_until_ns = clocks_.now_ns() + 350 * kMs;
  ASSERT_TRUE(sources_.stillness.push_back(&vehicle_));
  EXPECT_EQ(grab().code(), StatusCode::kUnavailable);
}

TEST_F(GrabberTest, BlankRoomAndNoSensor_IsTakenForMotion) {
  textured_ = false;
  EXPECT_EQ(grab().code(), StatusCode::kUnavailable);
  EXPECT_NE(reason().find("no camera sees enough"), std::string::npos);
}

TEST_F(GrabberTest, CameraThatDeliversNothing_IsLeftOutWithANote) {
  delivers_[1] = false;
  ASSERT_TRUE(grab().ok()) << reason();
  EXPECT_TRUE(shot_.images[1].empty());
  ASSERT_EQ(shot_.notes.size(), 1U);
  EXPECT_EQ(shot_.notes[0].view().substr(0, 4), "cam1");
}

TEST_F(GrabberTest, NoCameraDelivers_FailsAtOnce) {
  delivers_[0] = delivers_[1] = false;
  EXPECT_EQ(grab().code(), StatusCode::kTooFew);
  EXPECT_NE(reason().find("no camera delivers"), std::string::npos);
}

TEST_F(GrabberTest, Stopped_GivesEverythingBack) {
  watcher_.patience = 20;
  EXPECT_EQ(grab().code(), StatusCode::kCancelled);
  watcher_.patience = 100'000;
  EXPECT_TRUE(grab().ok());
}

TEST_F(GrabberTest, Trigger_FiresForEachSetOfImages) {
  sources_.trigger = this;
  ASSERT_TRUE(grab().ok()) << reason();
  EXPECT_EQ(fired_, 2);
}

TEST_F(GrabberTest, TriggerThatCannotFire_IsNamed) {
  sources_.trigger = this;
  trigger_status_ = {StatusCode::kUnavailable, "the line is in use: check the profile"};
  EXPECT_EQ(grab().code(), StatusCode::kNotFound);
  EXPECT_NE(reason().find("trigger line: the line is in use"), std::string::npos);
}

TEST_F(GrabberTest, ExposuresTooFarApart_AreRefusedWhereThereIsALimit) {
  options_.max_spread_ns = 2 * kMs;
  EXPECT_EQ(grab().code(), StatusCode::kUnavailable);
  EXPECT_NE(reason().find("apart"), std::string::npos);
}

}  // namespace
}  // namespace roomcal::grab
