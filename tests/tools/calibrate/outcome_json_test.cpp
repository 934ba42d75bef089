#include "tools/calibrate/outcome_json.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tools/calibrate/outcome_detail.h"
#include "tools/evaluate/trust_shot.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {
namespace {

using nlohmann::json;

template <int Rows, int Columns = Rows>
Eigen::Matrix<double, Rows, Columns> matrix_in(const json& rows) {
  Eigen::Matrix<double, Rows, Columns> m;
  for (int r = 0; r < Rows; ++r)
    for (int c = 0; c < Columns; ++c) m(r, c) = rows.at(r).at(c).get<double>();
  return m;
}

SE3 pose_in(const json& rows) { return SE3::from_matrix(matrix_in<4>(rows)); }

/// One shot of four cameras and two LiDARs, as observations, and its result.
class OutcomeJson : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    room_ = std::make_unique<TrustRoom>(1);
    device_ = std::make_unique<TrustDevice>(make_trust_device(*room_, 3));
    session_ = std::make_unique<TrustSession>(device_->device, room_->data());
    Random random = random_stream(5, 1);
    shot_ = std::make_unique<TrustShot>(take_trust_shot(*room_, *device_, place_trust_device(*room_, 4), {}, random));
    session_->run(*shot_, nullptr);
    const ResultContext context{"robot", "R-7", "roomcal host", 1'700'000'000, {"a.pcap", ""}, 4096};
    plain_ = to_json(session_->outcome(), device_->device, session_->map(), context);
    detailed_ = plain_;
    add_detail(session_->session(nullptr), session_->outcome(), detailed_);
  }
  static void TearDownTestSuite() {
    shot_.reset();
    session_.reset();
    device_.reset();
    room_.reset();
  }

  static const json& sensor(std::size_t number) { return detailed_.at("sensors").at(device_->name(number)); }
  static Vec3 place_of(std::size_t marker_id) {
    for (std::size_t m = 0; m < session_->map().marker_count(); ++m)
      if (session_->map().marker(m).id == marker_id) return session_->map().marker(m).p_room;
    return Vec3::Constant(NAN);
  }
  static std::size_t cameras() { return device_->device.cameras.size(); }

  static std::unique_ptr<TrustRoom> room_;
  static std::unique_ptr<TrustDevice> device_;
  static std::unique_ptr<TrustSession> session_;
  static std::unique_ptr<TrustShot> shot_;
  static json plain_, detailed_;
};
std::unique_ptr<TrustRoom> OutcomeJson::room_;
std::unique_ptr<TrustDevice> OutcomeJson::device_;
std::unique_ptr<TrustSession> OutcomeJson::session_;
std::unique_ptr<TrustShot> OutcomeJson::shot_;
json OutcomeJson::plain_, OutcomeJson::detailed_;

TEST_F(OutcomeJson, Plain_SaysWhereItComesFromAndHoldsNoRings) {
  EXPECT_EQ(plain_.at("device"), "robot");
  EXPECT_EQ(plain_.at("device_serial"), "R-7");
  EXPECT_EQ(plain_.at("firmware"), "roomcal host");
  EXPECT_EQ(plain_.at("measured_unix_s"), 1'700'000'000);
  EXPECT_EQ(plain_.at("sensors").at(device_->name(4)).at("file"), "a.pcap");
  EXPECT_FALSE(plain_.at("sensors").at(device_->name(5)).contains("file"));
  EXPECT_GT(plain_.at("sensors").at(device_->name(4)).at("sigma_m").get<double>(), 0.0);
  EXPECT_FALSE(plain_.contains("joint_covariance"));
  for (const json& sensor : plain_.at("sensors")) EXPECT_FALSE(sensor.contains("rings") || sensor.contains("nominal"));
}

TEST_F(OutcomeJson, Detail_TellsEveryRingAndTheMarkersOfTheInliers) {
  for (std::size_t i = 0; i < cameras(); ++i) {
    const json& rings = sensor(i).at("rings");
    EXPECT_EQ(rings.size(), shot_->rings[i].size());
    const auto used = std::count_if(rings.begin(), rings.end(), [](const json& r) { return r.contains("marker"); });
    EXPECT_EQ(used, sensor(i).at("inliers").get<long>());
  }
}

TEST_F(OutcomeJson, Detail_PredictsRingsWhereAnIndependentProjectionPutsTheMarkers) {
  for (std::size_t i = 0; i < cameras(); ++i) {
    const SE3 T_cam_room = pose_in(sensor(i).at("T_room_sensor")).inverse();
    for (const json& ring : sensor(i).at("rings")) {
      if (!ring.contains("marker")) continue;
      const auto id = ring.at("marker").get<std::size_t>();
      Vec2 expected_px;
      ASSERT_TRUE(device_->lenses[i].project(T_cam_room * place_of(id), expected_px).ok());
      EXPECT_NEAR(ring.at("predicted_px")[0].get<double>(), expected_px.x(), 1e-6);
      EXPECT_NEAR(ring.at("predicted_px")[1].get<double>(), expected_px.y(), 1e-6);
      for (const int k : {0, 2}) EXPECT_GE(ring.at("residual_cov_px2")[k], ring.at("cov_px2")[k]);
    }
  }
}

TEST_F(OutcomeJson, Detail_MarksAFifthAsHeldOut) {
  std::size_t held_out = 0, used = 0;
  for (std::size_t i = 0; i < cameras(); ++i)
    for (const json& ring : sensor(i).at("rings")) {
      used += ring.contains("marker") ? 1U : 0U;
      held_out += ring.value("held_out", false) ? 1U : 0U;
    }
  EXPECT_EQ(held_out, detailed_.at("held_out").at("markers").get<std::size_t>());
  EXPECT_NEAR(static_cast<double>(held_out) / static_cast<double>(used), 0.2, 0.1);
}

TEST_F(OutcomeJson, JointCovariance_HasEverySensorsOnItsDiagonal) {
  const json& joint = detailed_.at("joint_covariance");
  ASSERT_EQ(joint.at("sensors").size(), device_->sensors() - 1);
  ASSERT_EQ(joint.at("matrix").size(), 6 * (device_->sensors() - 1));
  const auto all = matrix_in<30>(joint.at("matrix"));
  for (int i = 0; i < 5; ++i) {
    const Mat66 own = matrix_in<6>(sensor(static_cast<std::size_t>(i) + 1).at("covariance"));
    EXPECT_EQ(joint.at("sensors")[i], device_->name(static_cast<std::size_t>(i) + 1));
    EXPECT_LT((all.block<6, 6>(6 * i, 6 * i) - own).norm(), 1e-9 * own.norm());
  }
  EXPECT_LT((all - all.transpose()).norm(), 1e-12 * all.norm());
}

TEST_F(OutcomeJson, JointCovariance_LeadsToThatOfEveryPair) {
  const auto all = matrix_in<30>(detailed_.at("joint_covariance").at("matrix"));
  const auto number = [](const std::string& name) {
    for (std::size_t i = 0; i < device_->sensors(); ++i)
      if (device_->name(i) == name) return static_cast<int>(i) - 1;
    return -2;
  };
  int pairs = 0;
  for (const json& pair : detailed_.at("pairs")) {
    const int a = number(pair.at("a")), b = number(pair.at("b"));
    if (a < 0 || b < 0) continue;                                           // those of the reference are the diagonal
    Eigen::Matrix<double, 6, 30> J = Eigen::Matrix<double, 6, 30>::Zero();  // xi_ab = xi_b - Ad(T_b_a) xi_a
    J.block<6, 6>(0, 6 * b).setIdentity();
    J.block<6, 6>(0, 6 * a) -= se3_adjoint(pose_in(pair.at("T_a_b")).inverse());
    const Mat66 expected = J * all * J.transpose(), told = matrix_in<6>(pair.at("covariance"));
    EXPECT_LT((expected - told).norm(), 1e-6 * told.norm()) << pair.at("a") << pair.at("b");
    ++pairs;
  }
  EXPECT_GE(pairs, 10);
}

TEST_F(OutcomeJson, Detail_KeepsTheDrawing) {
  for (std::size_t i = 0; i < device_->device.lidars.size(); ++i) {
    const json& nominal = sensor(cameras() + i).at("nominal");
    EXPECT_LT(
        (matrix_in<4>(nominal.at("T_rig_sensor")) - device_->device.lidars[i].nominal.T_rig_sensor.matrix()).norm(),
        1e-12);
    EXPECT_EQ(nominal.at("sigma_t_m"), device_->device.lidars[i].nominal.sigma_t_m);
  }
}

}  // namespace
}  // namespace roomcal::tools
