#include "runtime/grab/sweep_tray.h"

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/truth/lidar_box.h"

namespace roomcal::grab {
namespace {

constexpr std::size_t kPerTurn = 76;    // packets of a VLP-16 turn at 10 Hz, rounded up
constexpr std::size_t kPackets = 1100;  // more than a second: played again, their clock has jumped

/// A tray for a VLP-16 that turns in a box, and its packets without end.
class SweepTrayTest : public testing::Test {
 protected:
  SweepTrayTest() {
    stream_.first_ns = 10'000'000'000;
    returns_ = truth::box_returns(stream_, kPackets * tools::kVlp16FiringsPerPacket, {-1, -2, -1}, {2, 2, 1});
    memory_.resize(SweepTray::bytes(options_, 3));
    arena_ = Arena(memory_);
    created_ = tray_.create(calibration_, options_, 3, arena_);
  }
  tools::Vlp16Packet packet(std::size_t i) const {
    const std::size_t first = i * tools::kVlp16FiringsPerPacket;
    return tools::make_vlp16_packet(stream_, first, std::span(returns_).subspan(first * tools::kVlp16Lasers));
  }
  void send(std::size_t count) {
    for (; count > 0; --count) tray_.take({packet(next_++), {}});
  }
  void lose(std::size_t count) { next_ += count; }

  lidar::SweepOptions options_ = {.capacity = 32'000};
  lidar::Calibration calibration_ = lidar::built_in_calibration(lidar::Model::kVlp16).value();
  tools::Vlp16Stream stream_;
  std::vector<tools::Vlp16Return> returns_;
  std::vector<std::byte> memory_;
  Arena arena_;
  SweepTray tray_;
  Status created_;
  std::size_t next_ = 0;
};

TEST_F(SweepTrayTest, NotAsked_KeepsNothing) {
  ASSERT_TRUE(created_.ok());
  send(3 * kPerTurn);
  EXPECT_FALSE(tray_.full());
  EXPECT_TRUE(tray_.stop());
  EXPECT_TRUE(tray_.sweeps().empty());
  EXPECT_GT(tray_.counters().sweeps, 1U);
}

TEST_F(SweepTrayTest, Asked_KeepsWholeSweepsThatBeganAfterwards) {
  send(kPerTurn / 2);
  tray_.ask(2);
  send(kPerTurn);
  EXPECT_FALSE(tray_.full()) << "the sweep that was open began before";
  send(2 * kPerTurn);
  EXPECT_TRUE(tray_.full());
  EXPECT_TRUE(tray_.stop());
  ASSERT_EQ(tray_.sweeps().size(), 2U);
  EXPECT_GT(tray_.sweeps()[1].points.size(), 28'000U);
  EXPECT_GT(tray_.sweeps()[1].stamp.ns, tray_.sweeps()[0].stamp.ns);
  const float first_m = tray_.sweeps()[0].points[0].x_m;
  send(3 * kPerTurn);
  EXPECT_EQ(tray_.sweeps()[0].points[0].x_m, first_m) << "later packets must not touch what was kept";
}

TEST_F(SweepTrayTest, SweepWithALoss_IsDiscardedAndCounted) {
  send(kPerTurn / 2);
  tray_.ask(1);
  send(kPerTurn);
  lose(3);
  send(kPerTurn);
  EXPECT_FALSE(tray_.full());
  EXPECT_GE(tray_.discarded(), 1U);
  EXPECT_NE(tray_.discarded_flags() & lidar::kSweepLostPackets, 0U);
  send(2 * kPerTurn);
  EXPECT_TRUE(tray_.full());
}

TEST_F(SweepTrayTest, StoppedEarly_HasWhatCameSoFar) {
  send(kPerTurn / 2);
  tray_.ask(3);
  send(2 * kPerTurn + kPerTurn / 2);
  EXPECT_FALSE(tray_.full());
  EXPECT_TRUE(tray_.stop());
  const std::size_t kept = tray_.sweeps().size();
  EXPECT_GE(kept, 1U);
  send(2 * kPerTurn);
  EXPECT_EQ(tray_.sweeps().size(), kept);
}

TEST_F(SweepTrayTest, AskedForMoreThanThereIsRoom_KeepsWhatFits) {
  tray_.ask(100);
  send(6 * kPerTurn);
  EXPECT_TRUE(tray_.full());
  EXPECT_EQ(tray_.sweeps().size(), 3U);
}

TEST_F(SweepTrayTest, Create_RefusesNoRoomAndTooSmallArenas) {
  SweepTray tray;
  Arena small(std::span<std::byte>(memory_).first(1000));
  EXPECT_EQ(tray.create(calibration_, options_, 0, arena_).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(tray.create(calibration_, options_, kMaxTraySweeps + 1, arena_).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(tray.create(calibration_, options_, 1, small).code(), StatusCode::kOutOfMemory);
}

TEST_F(SweepTrayTest, TwoThreads_SweepsAreWholeWheneverTheyAreAskedFor) {
  std::vector<tools::Vlp16Packet> packets;
  for (std::size_t i = 0; i < kPackets; ++i) packets.push_back(packet(i));
  std::atomic<bool> end{false};
  std::thread receiver([&] {
    for (std::size_t i = 0; !end; i = (i + 1) % kPackets) {
      tray_.take({packets[i], {}});
      // As on a socket, which is empty at times: one that never rests is at work whenever it loses its processor.
      if (i % 4 == 0) std::this_thread::sleep_for(std::chrono::microseconds(10));
    }
  });
  int sweeps = 0;
  for (int i = 0; i < 50; ++i) {
    tray_.ask(2);
    for (int wait = 0; wait < i && !tray_.full(); ++wait) std::this_thread::sleep_for(std::chrono::microseconds(200));
    while (!tray_.stop()) std::this_thread::yield();
    for (const lidar::Sweep& sweep : tray_.sweeps()) {
      EXPECT_GT(sweep.points.size(), 28'000U);
      ++sweeps;
    }
  }
  end = true;
  receiver.join();
  EXPECT_GT(sweeps, 0);
}

}  // namespace
}  // namespace roomcal::grab
