#include "tools/join/tie.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/truth/random.h"
#include "tools/common/error.h"

namespace roomcal::tools {
namespace {

constexpr std::size_t kShots = 3, kUnits = 4;

/// Sightings of units 0..3 in three shots, off by draws from a covariance in which all of them share errors, as they
/// do through a map.
class Drawn {
 public:
  explicit Drawn(uint64_t seed) : random_(seed) {
    for (SE3& T : T_rig_unit_) T = {so3_exp(random_.normals<3>()), 0.2 * random_.normals<3>()};
    T_rig_unit_[0] = SE3();
    for (SE3& T : T_room_rig_) T = {so3_exp(random_.normals<3>()), random_.normals<3>()};
    input_.shots = kShots;
    input_.units = kUnits;
    for (std::size_t s = 0; s < kShots; ++s)
      for (std::size_t u = 0; u < kUnits; ++u) input_.sightings.push_back({s, u, {}, kNone});
    lay_out_errors();
  }

  /// Leaves a sighting out.
  void blind(std::size_t shot, std::size_t unit) {
    std::erase_if(input_.sightings, [&](const Sighting& s) { return s.shot == shot && s.unit == unit; });
    lay_out_errors();
  }

  TieInput draw() {
    Eigen::VectorXd white(root_.cols());
    for (double& w : white) w = random_.normal();
    const Eigen::VectorXd error = root_ * white;
    for (std::size_t k = 0; k < input_.sightings.size(); ++k) {
      Sighting& s = input_.sightings[k];
      const Vec6 off = error.segment<6>(static_cast<Eigen::Index>(6 * k));
      s.T_room_sensor = truth(s) * se3_exp(-off);  // truth = seen exp(off)
    }
    return input_;
  }

  SE3 truth(const Sighting& s) const { return T_room_rig_[s.shot] * T_rig_unit_[s.unit]; }
  const SE3& T_rig_unit(std::size_t unit) const { return T_rig_unit_[unit]; }
  void move(std::size_t unit, const Vec6& xi, TieInput& input) const {
    for (Sighting& s : input.sightings)
      if (s.unit == unit && s.shot == kShots - 1) s.T_room_sensor = s.T_room_sensor * se3_exp(xi);
  }

 private:
  void lay_out_errors() {
    const auto size = static_cast<Eigen::Index>(6 * input_.sightings.size());
    root_ = Eigen::MatrixXd(size, size + 6);
    for (double& r : root_.reshaped()) r = 2e-4 * random_.normal() / std::sqrt(static_cast<double>(size));
    root_.diagonal().array() += 3e-4;
    root_.rightCols(6).array() += 2e-4 * random_.normal();  // common to all
    input_.cov = root_ * root_.transpose();
  }

  truth::Random random_;
  std::array<SE3, kUnits> T_rig_unit_;
  std::array<SE3, kShots> T_room_rig_;
  TieInput input_;
  Eigen::MatrixXd root_;
};

double nees(const TieSolution& tied, const Drawn& drawn, std::size_t unit) {
  const auto row = static_cast<Eigen::Index>(6 * unit);
  const Mat66 cov = tied.cov.block<6, 6>(row, row);
  const Vec6 error = se3_log(tied.T_rig_unit[unit].inverse() * drawn.T_rig_unit(unit));
  return error.dot(cov.ldlt().solve(error));
}

TEST(Tie, ManyDraws_ErrorsAreAsTheCovarianceSaysAndContradictionsAsChance) {
  constexpr int kDraws = 300;
  Drawn drawn(1);
  double sum = 0, chi2 = 0;
  int degrees_of_freedom = 0;
  for (int i = 0; i < kDraws; ++i) {
    const TieSolution tied = tie(drawn.draw());
    for (std::size_t u = 1; u < kUnits; ++u) sum += nees(tied, drawn, u) / (kDraws * (kUnits - 1));
    chi2 += tied.chi2 / kDraws;
    degrees_of_freedom = tied.degrees_of_freedom;
  }
  EXPECT_NEAR(sum, 6, 0.5);
  EXPECT_EQ(degrees_of_freedom, 6 * static_cast<int>(kShots * kUnits - kShots - (kUnits - 1)));
  EXPECT_NEAR(chi2, degrees_of_freedom, 0.05 * degrees_of_freedom);
}

TEST(Tie, OneShot_IsTheRelativePoseOfThatShot) {
  Drawn drawn(2);
  TieInput input = drawn.draw();
  input.shots = 1;
  input.sightings.resize(kUnits);
  input.cov = Eigen::MatrixXd(input.cov.topLeftCorner<6 * kUnits, 6 * kUnits>());
  const TieSolution tied = tie(input);
  for (std::size_t u = 1; u < kUnits; ++u) {
    const SE3 T = input.sightings[0].T_room_sensor.inverse() * input.sightings[u].T_room_sensor;
    EXPECT_LT(se3_log(T.inverse() * tied.T_rig_unit[u]).norm(), 1e-12);
    const Mat66 Ad = se3_adjoint(T.inverse());
    const auto row = static_cast<Eigen::Index>(6 * u);
    const Mat66 cross = Ad * input.cov.block<6, 6>(0, row);
    const Mat66 expected =
        input.cov.block<6, 6>(row, row) + Ad * input.cov.block<6, 6>(0, 0) * Ad.transpose() - cross - cross.transpose();
    EXPECT_LT((tied.cov.block<6, 6>(row, row) - expected).norm(), 1e-6 * expected.norm());
  }
  EXPECT_EQ(tied.degrees_of_freedom, 0);
  EXPECT_LT(tied.chi2, 1e-9);
}

TEST(Tie, MoreShots_LeaveLessUncertainty) {
  Drawn drawn(3);
  const TieInput input = drawn.draw();
  TieInput first = input;
  first.sightings.resize(kUnits);
  first.cov = Eigen::MatrixXd(input.cov.topLeftCorner<6 * kUnits, 6 * kUnits>());
  const TieSolution one = tie(first), three = tie(input);
  EXPECT_LT(three.cov.diagonal().segment<18>(6).sum(), 0.7 * one.cov.diagonal().segment<18>(6).sum());
}

TEST(Tie, UnitThatNoShotSeesWithTheReference_ComesThroughAnotherUnit) {
  Drawn drawn(4);
  drawn.blind(0, 3);
  drawn.blind(1, 3);
  drawn.blind(2, 0);
  const TieSolution tied = tie(drawn.draw());
  ASSERT_TRUE(tied.known[3]);
  EXPECT_LT(nees(tied, drawn, 3), 30);
}

TEST(Tie, ShotThatSharesNoUnit_TakesNoPart) {
  Drawn drawn(5);
  for (const std::size_t shot : {0U, 1U}) drawn.blind(shot, 3);
  for (const std::size_t unit : {0U, 1U, 2U}) drawn.blind(2, unit);
  const TieSolution tied = tie(drawn.draw());
  EXPECT_FALSE(tied.known[3]);
  EXPECT_FALSE(tied.placed[2]);
  EXPECT_TRUE(tied.placed[1]);
}

TEST(Tie, Mount_CarriesWhatIsOpenAndNothingElse) {
  Drawn drawn(6);
  TieInput input = drawn.draw();
  const auto open = static_cast<Eigen::Index>(2);  // unit 3's own z, in all shots
  for (std::size_t k = 0; k < input.sightings.size(); ++k)
    if (input.sightings[k].unit == 3)
      input.cov(static_cast<Eigen::Index>(6 * k) + open, static_cast<Eigen::Index>(6 * k) + open) += 1;
  input.mounts.push_back({3, drawn.T_rig_unit(3), 0.008, 0.02});
  const TieSolution tied = tie(input);
  EXPECT_NEAR(std::sqrt(tied.cov(18 + open, 18 + open)), 0.008, 0.001);
  EXPECT_GT(std::sqrt(tied.cov_free(18 + open, 18 + open)), 0.3);
  EXPECT_LT(std::sqrt(tied.cov(18, 18)), 0.001);
}

TEST(Tie, LensSeenInAllShots_IsOneLens) {
  Drawn drawn(7);
  TieInput input = drawn.draw();
  const Eigen::MatrixXd poses = input.cov;
  const Eigen::Index size = poses.rows();
  input.cov = Eigen::MatrixXd::Zero(size + 24, size + 24);
  input.cov.topLeftCorner(size, size) = poses;
  for (std::size_t s = 0; s < kShots; ++s) {
    const auto first = size + static_cast<Eigen::Index>(8 * s);
    input.sightings[kUnits * s + 1].lens = s;
    camera::Parameters lens = camera::Parameters::Zero();
    lens[0] = 600 + static_cast<double>(s);
    input.lens.push_back(lens);
    input.cov(first, first) = 0.5 * 0.5;                                  // the others are held
    input.cov(first, 8) = input.cov(8, first) = s == 0 ? 1e-4 * 0.1 : 0;  // a focal length that pulls a pose along
  }
  const TieSolution tied = tie(input);
  EXPECT_NEAR(tied.lens[1][0], 601, 0.2);
  const auto lens_at = static_cast<Eigen::Index>(6 * kUnits + 8);
  EXPECT_NEAR(std::sqrt(tied.cov(lens_at, lens_at)), 0.5 / std::sqrt(3.0), 0.01);
  EXPECT_EQ(tied.cov(lens_at + 1, lens_at + 1), 0);
}

TEST(OddOneOut, UnitMovedBetweenShots_IsNamedAlsoWhereItIsTheReference) {
  for (std::size_t unit = 0; unit < kUnits; ++unit) {
    Drawn drawn(10 + unit);
    TieInput input = drawn.draw();
    EXPECT_GT(chi_square_tail(tie(input).chi2, tie(input).degrees_of_freedom), 1e-3);
    Vec6 xi = Vec6::Zero();
    xi[static_cast<Eigen::Index>(unit)] = 0.008;
    drawn.move(unit, xi, input);
    const TieSolution tied = tie(input);
    EXPECT_LT(chi_square_tail(tied.chi2, tied.degrees_of_freedom), 1e-6);
    EXPECT_EQ(odd_one_out(input, 1e-3), unit);
  }
}

TEST(ChiSquareTail, MatchesTheTable) {
  EXPECT_NEAR(chi_square_tail(12.592, 6), 0.05, 0.001);
  EXPECT_NEAR(chi_square_tail(37.566, 20), 0.01, 0.0005);
  EXPECT_EQ(chi_square_tail(3, 0), 1);
}

TEST(Tie, CovarianceThatIsNone_IsRefused) {
  Drawn drawn(8);
  TieInput input = drawn.draw();
  input.cov.row(3) = input.cov.row(2);
  input.cov.col(3) = input.cov.col(2);
  input.cov(3, 3) = -input.cov(2, 2);
  EXPECT_THROW(tie(input), ToolError);
}

}  // namespace
}  // namespace roomcal::tools
