#include "runtime/rig/plane_terms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "runtime/rig/lidar_terms.h"
#include "tests/runtime/rig/lidar_gradient.h"
#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

constexpr std::size_t kPlanes = 5, kLidars = 2;

/// Cameras that see markers on five planes, and two LiDARs that see the planes. A plane's error is minus the mean of
/// its markers' errors along its normal, with the tilts that go with it, and an error of its own.
class Rig {
 public:
  explicit Rig(uint64_t seed, double marker_sigma_m, double own_sigma) : random_(seed), own_sigma_(own_sigma) {
    room_ = truth::make_room(random_);
    options_.cameras = 3;
    options_.map_cov_m2 = marker_sigma_m * marker_sigma_m * Mat33::Identity();
    shot_ = test::make_shot(random_, room_, options_);
    tie_planes();
    for (std::size_t l = 0; l < kLidars; ++l) {
      T_room_lidar_[l] = shot_.T_room_cam[0] * SE3{so3_exp(random_.normals<3>()), 0.1 * random_.normals<3>()};
      for (std::size_t p = 0; p < kPlanes; ++p) add_plane(p, l);
    }
  }

  /// New errors of map, rings and ranges around the same truth.
  void draw() {
    test::redraw(random_, room_, options_, shot_);
    std::vector<Vec3> error(kPlanes);
    for (Vec3& e : error) e = own_sigma_ * random_.normals<3>();
    for (std::size_t m = 0; m < room_.size(); ++m) {
      shot_.landmarks[m].plane = landmarks_[m].plane;
      shot_.landmarks[m].plane_by_point = landmarks_[m].plane_by_point;
      error[landmarks_[m].plane] += landmarks_[m].plane_by_point * (room_[m].p_room - shot_.landmarks[m].p_room);
    }
    lidars_.clear();
    for (std::size_t l = 0; l < kLidars; ++l) {
      LidarView lidar;
      lidar.points.T_hat = T_room_lidar_[l] * se3_exp(1e-4 * random_.normals<6>());
      lidar.points.information = information_[l];
      Vec6 off = se3_log(lidar.points.T_hat.inverse() * T_room_lidar_[l]);
      const Mat66 root = information_[l].llt().matrixL();
      lidar.points.gradient = information_[l] * off + root * random_.normals<6>();
      for (const PlanePull& pull : pulls_[l]) lidar.points.gradient += pull.pull * error[pull.plane];
      lidar.pulls = pulls_[l];
      lidars_.push_back(lidar);
    }
  }

  Status solve(bool planes_known_to_be_off = true) {
    views_ = shot_.views();
    RigInput input{views_, lidars_, 0, shot_.landmarks};
    if (planes_known_to_be_off) input.plane_cov = plane_cov_;
    Arena step{step_bytes_}, scratch{scratch_bytes_};
    Eigen::internal::set_is_malloc_allowed(false);
    const Status status = solve_rig(input, {}, step, scratch, solution);
    Eigen::internal::set_is_malloc_allowed(true);
    return status;
  }

  double nees(std::size_t a, std::size_t b) const {
    const auto truth = [&](std::size_t s) { return s < 3 ? shot_.T_room_cam[s] : T_room_lidar_[s - 3]; };
    const RelativePose pair = relative_pose(solution, a, b);
    const Vec6 error = test::pose_error(pair.T_a_b, truth(a).inverse() * truth(b));
    return error.dot(pair.cov.ldlt().solve(error));
  }

  const std::vector<Mat33>& plane_cov() const { return plane_cov_; }
  Mat66 information(std::size_t lidar) const { return information_[lidar]; }
  const PlanePull& pull(std::size_t lidar, std::size_t i) const { return pulls_[lidar][i]; }
  std::vector<Landmark>& landmarks() { return landmarks_; }
  test::Shot& shot() { return shot_; }
  std::vector<LidarView>& lidars() { return lidars_; }

  RigSolution solution;

 private:
  static Vec3 side_of(const Vec3& normal) { return normal.unitOrthogonal(); }
  static Vec3 lever_of(const Vec3& normal, const Vec3& p) {
    return {1, side_of(normal).dot(p), side_of(normal).cross(normal).dot(p)};
  }

  /// Ranges to where the plane's markers are. They see the plane move by M xi as the LiDAR moves by xi: distances along
  /// the normal change by n . R (rho + phi x p_lidar).
  void add_plane(std::size_t plane, std::size_t lidar) {
    const SE3& T = T_room_lidar_[lidar];
    Mat33 weight = Mat33::Zero();
    Vec3 n = Vec3::Zero();
    for (std::size_t m = 0; m < room_.size(); ++m) {
      if (landmarks_[m].plane != plane) continue;
      n = room_[m].normal_room;
      const Vec3 lever = lever_of(n, room_[m].p_room);
      weight += lever * lever.transpose() / (0.001 * 0.001);
    }
    const Vec3 u = side_of(n), v = u.cross(n);
    Eigen::Matrix<double, 3, 6> M = Eigen::Matrix<double, 3, 6>::Zero();
    M.row(0) << (T.R.transpose() * n).transpose(), -(T.R.transpose() * T.t.cross(n)).transpose();
    M.block<1, 3>(1, 3) = (T.R.transpose() * u.cross(n)).transpose();
    M.block<1, 3>(2, 3) = (T.R.transpose() * v.cross(n)).transpose();
    information_[lidar] += M.transpose() * weight * M;
    pulls_[lidar].push_back({static_cast<uint16_t>(plane), M.transpose() * weight});
  }

  void tie_planes() {
    landmarks_.resize(room_.size());
    plane_cov_.assign(kPlanes, own_sigma_ * own_sigma_ * Mat33::Identity());
    std::vector<Mat33> AtA(kPlanes, Mat33::Zero());
    const auto lever = [&](std::size_t m) { return lever_of(room_[m].normal_room, room_[m].p_room); };
    for (std::size_t m = 0; m < room_.size(); ++m) {
      Eigen::Index axis = 0;
      room_[m].normal_room.cwiseAbs().maxCoeff(&axis);
      landmarks_[m].plane =
          static_cast<uint16_t>(axis == 2 ? 0 : 1 + 2 * axis + (room_[m].normal_room[axis] < 0 ? 1 : 0));
      AtA[landmarks_[m].plane] += lever(m) * lever(m).transpose();
    }
    for (std::size_t m = 0; m < room_.size(); ++m) {
      Landmark& landmark = landmarks_[m];
      landmark.plane_by_point = -AtA[landmark.plane].inverse() * lever(m) * room_[m].normal_room.transpose();
      plane_cov_[landmark.plane] += landmark.plane_by_point * options_.map_cov_m2 * landmark.plane_by_point.transpose();
    }
  }

  truth::Random random_;
  double own_sigma_;
  std::vector<truth::RoomMarker> room_;
  test::ShotOptions options_;
  test::Shot shot_;
  std::array<SE3, kLidars> T_room_lidar_;
  std::array<Mat66, kLidars> information_ = {Mat66::Zero(), Mat66::Zero()};
  std::array<std::vector<PlanePull>, kLidars> pulls_;
  std::vector<Landmark> landmarks_;
  std::vector<Mat33> plane_cov_;
  std::vector<LidarView> lidars_;
  std::vector<CameraView> views_;
  std::vector<std::byte> step_bytes_ = std::vector<std::byte>(1U << 20U);
  std::vector<std::byte> scratch_bytes_ = std::vector<std::byte>(4U << 20U);
};

TEST(PlaneTerms, TwoLidars_ShareTheErrorsOfThePlanesTheySee) {
  Rig rig(1, 0.004, 1e-4);
  rig.draw();
  ASSERT_TRUE(rig.solve().ok());
  Eigen::Matrix<double, 12, 12> expected = Eigen::Matrix<double, 12, 12>::Zero();
  for (std::size_t a = 0; a < kLidars; ++a)
    for (std::size_t b = 0; b < kLidars; ++b) {
      Mat66 block = a == b ? Mat66(rig.information(a).inverse()) : Mat66(Mat66::Zero());
      for (std::size_t p = 0; p < kPlanes; ++p)
        block += rig.information(a).inverse() * rig.pull(a, p).pull * rig.plane_cov()[p] *
                 rig.pull(b, p).pull.transpose() * rig.information(b).inverse();
      expected.block<6, 6>(static_cast<Eigen::Index>(6 * a), static_cast<Eigen::Index>(6 * b)) = block;
    }
  for (std::size_t a = 0; a < kLidars; ++a)
    for (std::size_t b = 0; b < kLidars; ++b)
      EXPECT_LT((rig.solution.cov_block(3 + a, 3 + b) -
                 expected.block<6, 6>(static_cast<Eigen::Index>(6 * a), static_cast<Eigen::Index>(6 * b)))
                    .norm(),
                1e-3 * expected.norm());
  EXPECT_GT(rig.solution.cov_block(3, 4).norm(), 0.1 * rig.solution.cov_block(3, 3).norm());
}

TEST(PlaneTerms, ExactPlanesOrNone_ChangeNothing) {
  Rig rig(2, 0, 0);
  rig.draw();
  ASSERT_TRUE(rig.solve(true).ok());
  const Mat66 with = rig.solution.cov_block(3, 3);
  const SE3 T_with = rig.solution.T_room_sensor[4];
  ASSERT_TRUE(rig.solve(false).ok());
  EXPECT_EQ(with, rig.solution.cov_block(3, 3));
  EXPECT_EQ(T_with.matrix(), rig.solution.T_room_sensor[4].matrix());
}

TEST(PlaneTerms, GradientOfTheLidarsTogether_IsHalfTheDerivativeOfTheirCost) {
  Rig rig(3, 0.003, 1e-4);
  rig.draw();
  std::vector<std::byte> memory(4U << 20U);
  Arena scratch{memory};
  const std::vector<CameraView> views = rig.shot().views();
  RigInput input{views, rig.lidars(), kNoReference, rig.shot().landmarks};
  input.plane_cov = rig.plane_cov();
  JointProblem problem;
  NormalEquations equations;
  ASSERT_TRUE(JointProblem::build(input, {}, scratch, problem).ok());
  ASSERT_TRUE(NormalEquations::build(5, 0, scratch, equations).ok());
  ASSERT_TRUE(problem.planes.used());
  truth::Random random(5);
  for (std::size_t l = 3; l < 5; ++l)
    problem.state.T_room_sensor[l] = problem.state.T_room_sensor[l] * se3_exp(0.02 * random.normals<6>());
  add_lidars(problem, equations);
  for (std::size_t k = 18; k < 30; ++k) {
    const double numeric = test::lidar_cost_derivative(problem, 5, k);
    EXPECT_NEAR(2 * equations.gradient[k], numeric, 1e-5 * std::abs(numeric) + 1e-2) << k;
  }
}

/// Mean NEES of all pairs of one kind over many maps and shots.
struct Kinds {
  double cameras = 0, mixed = 0, lidars = 0;
};
Kinds run(Rig& rig, bool tied) {
  constexpr int kShots = 400;
  Kinds mean;
  for (int i = 0; i < kShots; ++i) {
    rig.draw();
    if (!tied)
      for (Landmark& landmark : rig.shot().landmarks) landmark.plane = kNoPlane;
    const Status status = rig.solve();
    EXPECT_TRUE(status.ok()) << status.detail();
    if (!status.ok()) return mean;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 3; b < 5; ++b) mean.mixed += rig.nees(a, b) / (6 * kShots);
      mean.cameras += rig.nees(a, (a + 1) % 3) / (3 * kShots);
    }
    mean.lidars += rig.nees(3, 4) / kShots;
  }
  return mean;
}

TEST(PlaneTerms, MarkersOfTwoMillimetresMakeThePlanes_NeesOfEveryKindOfPairIsSix) {
  for (const uint64_t seed : {11U, 12U}) {
    Rig rig(seed, 0.002, 5e-5);
    const Kinds mean = run(rig, true);
    std::printf("planes fitted to markers of 2 mm: NEES camera-camera %.2f, camera-LiDAR %.2f, LiDAR-LiDAR %.2f\n",
                mean.cameras, mean.mixed, mean.lidars);
    // 400 shots: sigma of a mean is sqrt(12 / 400) = 0.17; pairs of one shot are not independent of each other.
    EXPECT_NEAR(mean.cameras, 6, 0.6);
    EXPECT_NEAR(mean.mixed, 6, 0.6);
    EXPECT_NEAR(mean.lidars, 6, 0.6);
  }
}

// Why the tie is there: planes and markers off together are less off from each other.
TEST(PlaneTerms, MarkersTakenAsIndependentOfTheirPlane_MakeCameraAndLidarLookWorseThanTheyAre) {
  Rig rig(11, 0.005, 1e-5);
  const double independent = run(rig, false).mixed;
  std::printf("the same with planes taken as independent of markers: NEES camera-LiDAR %.2f\n", independent);
  EXPECT_LT(independent, 5.7);  // the lower end of the 95 % band of a thousand
}

TEST(PlaneTerms, InputThatIsNone_IsRefused) {
  Rig rig(4, 0.002, 1e-4);
  rig.draw();
  rig.shot().landmarks[0].plane_by_point(1, 1) = std::nan("");
  EXPECT_EQ(rig.solve().code(), StatusCode::kInvalidArgument);
  rig.draw();
  const_cast<std::vector<Mat33>&>(rig.plane_cov())[2](0, 0) = -1;
  EXPECT_EQ(rig.solve().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace roomcal::rig
