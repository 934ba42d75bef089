#include "runtime/lidar/ip_fragments.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::lidar {
namespace {

using Answer = IpFragments::Answer;

class IpFragmentsTest : public testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t i = 0; i < body_.size(); ++i) body_[i] = static_cast<std::byte>(i * 7 + i / 256);
  }
  // Bytes [from, to) of the body, of datagram `id`.
  IpFragment piece(std::size_t from, std::size_t to, uint16_t id = 1, uint64_t frame = 1) const {
    IpFragment result;
    result.source = 0x0A000001;
    result.destination = 0x0A000002;
    result.identification = id;
    result.at = from;
    result.body = Bytes(body_).subspan(from, to - from);
    result.more = to < body_.size();
    result.frame = frame;
    return result;
  }
  Answer add(const IpFragment& fragment) { return fragments_->add(fragment, whole_); }

  std::vector<std::byte> body_ = std::vector<std::byte>(12'616);
  std::unique_ptr<IpFragments> fragments_ = std::make_unique<IpFragments>();
  Bytes whole_;
};

TEST_F(IpFragmentsTest, EveryOrder_GivesTheWhole) {
  std::vector<IpFragment> pieces;
  for (std::size_t at = 0; at < body_.size(); at += 1480)
    pieces.push_back(piece(at, std::min(at + 1480, body_.size())));
  truth::Random random(5);
  for (int round = 0; round < 50; ++round) {
    for (std::size_t i = pieces.size() - 1; i > 0; --i) std::swap(pieces[i], pieces[random.index(i + 1)]);
    for (std::size_t i = 0; i + 1 < pieces.size(); ++i) ASSERT_EQ(add(pieces[i]), Answer::kWaits);
    ASSERT_EQ(add(pieces.back()), Answer::kWhole);
    EXPECT_TRUE(std::equal(whole_.begin(), whole_.end(), body_.begin(), body_.end()));
  }
  fragments_->finish();
  EXPECT_EQ(fragments_->unfinished(), 0U);
}

TEST_F(IpFragmentsTest, PieceAgain_IsPassedOver) {
  EXPECT_EQ(add(piece(0, 8000)), Answer::kWaits);
  EXPECT_EQ(add(piece(0, 8000)), Answer::kWaits);
  EXPECT_EQ(add(piece(8000, body_.size())), Answer::kWhole);
}

TEST_F(IpFragmentsTest, TwoDatagramsAtOnce_AreKeptApart) {
  EXPECT_EQ(add(piece(0, 8000, 1)), Answer::kWaits);
  EXPECT_EQ(add(piece(8000, body_.size(), 2)), Answer::kWaits);
  EXPECT_EQ(add(piece(0, 8000, 2)), Answer::kWhole);
  EXPECT_EQ(add(piece(8000, body_.size(), 1)), Answer::kWhole);
}

TEST_F(IpFragmentsTest, OverlappingPieces_AreGivenUp) {
  EXPECT_EQ(add(piece(0, 8000)), Answer::kWaits);
  EXPECT_EQ(add(piece(7992, body_.size())), Answer::kMalformed);
  EXPECT_EQ(add(piece(0, 8)), Answer::kWaits);  // a hole as large as an overlap
  EXPECT_EQ(add(piece(8, 24)), Answer::kWaits);
  EXPECT_EQ(add(piece(16, 24)), Answer::kWaits);
  EXPECT_EQ(add(piece(32, body_.size())), Answer::kMalformed);
  fragments_->finish();
  EXPECT_EQ(fragments_->unfinished(), 0U);
}

TEST_F(IpFragmentsTest, BeyondWhatIpCarries_IsRefused) {
  IpFragment far = piece(0, 16);
  far.at = 65'528;
  EXPECT_EQ(add(far), Answer::kMalformed);
  far.at = SIZE_MAX;
  EXPECT_EQ(add(far), Answer::kMalformed);
  far.at = 65'519;
  EXPECT_EQ(add(far), Answer::kWaits);
  EXPECT_EQ(add(piece(5, 5)), Answer::kMalformed);
}

TEST_F(IpFragmentsTest, LostPieces_AreForgottenAndCounted) {
  EXPECT_EQ(add(piece(0, 8000, 1, 10)), Answer::kWaits);
  EXPECT_EQ(add(piece(0, 8000, 2, 20)), Answer::kWaits);
  EXPECT_EQ(add(piece(0, 8000, 3, 10 + IpFragments::kMaxWaitFrames + 1)), Answer::kWaits);
  EXPECT_EQ(fragments_->unfinished(), 1U);
  EXPECT_EQ(add(piece(8000, body_.size(), 2, 10 + IpFragments::kMaxWaitFrames + 1)), Answer::kWhole);
  fragments_->finish();
  EXPECT_EQ(fragments_->unfinished(), 2U);
}

TEST_F(IpFragmentsTest, MoreThanThereIsRoomFor_TheOldestMakeRoom) {
  for (uint16_t id = 0; id < IpFragments::kMaxPieces + 10; ++id) EXPECT_EQ(add(piece(0, 8000, id, id)), Answer::kWaits);
  EXPECT_EQ(fragments_->unfinished(), 10U);
  EXPECT_EQ(add(piece(8000, body_.size(), IpFragments::kMaxPieces, IpFragments::kMaxPieces + 10)), Answer::kWhole);
}

}  // namespace
}  // namespace roomcal::lidar
