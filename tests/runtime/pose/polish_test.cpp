#include "runtime/pose/polish.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/pose/scene.h"

namespace roomcal::pose {
namespace {

/// One look into a room with every marker in view seen, and the true match.
class Look : public testing::Test {
 protected:
  void SetUp() override {
    truth::Random random(21);
    room_ = truth::make_room(random);
    map_ = make_map_scene(room_, {}, 1);
    camera_ = truth::make_camera(truth::LensKind::kWide);
    T_room_cam_ = truth::random_T_room_rig(random) * truth::make_device(random, 1, truth::LensKind::kWide)[0].T_rig_cam;
    ShotOptions options;
    options.sigma_px = 1e-6;
    options.missed = options.false_alarms = 0;
    image_ = make_image_scene(room_, camera_, T_room_cam_, options, random);
    // The stated covariance stays a camera's: the likelihood is asked about poses a little off.
    for (Observation& o : image_.observations) o.cov_px2 = 0.01 * Mat22::Identity();
    bytes_.resize(1 << 20);
    Arena arena(bytes_);
    ASSERT_TRUE(make_sights(camera_, image_.observations, 3.0, arena, set_).ok());
    match_.resize(set_.sights.size());
    work_.resize(set_.sights.size());
  }

  double distance(const SE3& T_room_cam) const { return se3_log(T_room_cam_.inverse() * T_room_cam).norm(); }

  std::vector<truth::RoomMarker> room_;
  MapScene map_;
  camera::Camera camera_ = truth::make_camera(truth::LensKind::kWide);
  SE3 T_room_cam_;
  ImageScene image_;
  std::vector<std::byte> bytes_;
  SightSet set_;
  std::vector<uint16_t> match_;
  std::vector<double> work_;
};

TEST_F(Look, MatchAtTheTruth_NamesEveryMarker) {
  const Matcher matcher(set_, map_.index);
  const Support support = matcher.match(T_room_cam_, 1.0, match_, work_);
  EXPECT_EQ(support.inliers, static_cast<int>(set_.sights.size()));
  for (std::size_t k = 0; k < match_.size(); ++k) EXPECT_EQ(match_[k], image_.marker[set_.sights[k].observation]);
}

TEST_F(Look, LikelihoodIsHighestAtTheTruth) {
  const Matcher matcher(set_, map_.index);
  const double best = matcher.match(T_room_cam_, 1.0, match_, work_).log_likelihood;
  for (int axis = 0; axis < 6; ++axis) {
    Vec6 step = Vec6::Zero();
    for (const double size : {-0.003, 0.003}) {
      step[axis] = size;
      EXPECT_LT(matcher.match(T_room_cam_ * se3_exp(step), 1.0, match_, work_).log_likelihood, best - 1) << axis;
    }
  }
}

TEST_F(Look, PoseOutsideTheRoomOrBehindTheMarkers_IsNotPlausible) {
  const Matcher matcher(set_, map_.index);
  matcher.match(T_room_cam_, 1.0, match_, work_);
  const std::array<uint16_t, 3> sight = {0, 1, 2};
  const map::MarkerTriple marker = {match_[0], match_[1], match_[2]};
  EXPECT_TRUE(matcher.is_plausible(T_room_cam_, sight, marker));
  SE3 away = T_room_cam_;
  away.t.x() += 30;
  EXPECT_FALSE(matcher.is_plausible(away, sight, marker));
  EXPECT_GE(matcher.neighbours_seen(T_room_cam_, marker, 4.0, 2), 2);
}

TEST_F(Look, StartCentimetresOff_IsPolishedToTheTruth) {
  const Matcher matcher(set_, map_.index);
  Vec6 step;
  step << 0.01, -0.008, 0.006, 0.003, -0.004, 0.002;
  PolishedPose pose;
  ASSERT_TRUE(polish(matcher, T_room_cam_ * se3_exp(step), match_, work_, pose).ok());
  EXPECT_LT(distance(pose.T_room_cam), 1e-5);
  EXPECT_EQ(pose.support.inliers, static_cast<int>(set_.sights.size()));
  EXPECT_GT(pose.cov.diagonal().minCoeff(), 0);
}

TEST_F(Look, TwoMatches_AreTooFewAndLeaveThePose) {
  std::fill(match_.begin(), match_.end(), kNoMarker);
  match_[0] = 0;
  match_[1] = 1;
  SE3 T_room_cam = T_room_cam_;
  Mat66 cov;
  EXPECT_EQ(refine_pose(set_, map_.index, match_, 5, T_room_cam, cov).code(), StatusCode::kTooFew);
  EXPECT_TRUE(T_room_cam.R == T_room_cam_.R && T_room_cam.t == T_room_cam_.t);
}

TEST_F(Look, OneMarkerThreeTimes_IsDegenerate) {
  std::fill(match_.begin(), match_.end(), kNoMarker);
  match_[0] = match_[1] = match_[2] = 4;
  SE3 T_room_cam = T_room_cam_;
  Mat66 cov;
  EXPECT_EQ(refine_pose(set_, map_.index, match_, 5, T_room_cam, cov).code(), StatusCode::kDegenerate);
  EXPECT_TRUE(T_room_cam.R == T_room_cam_.R && T_room_cam.t == T_room_cam_.t);
}

}  // namespace
}  // namespace roomcal::pose
