// One rendered shot of the stereo rig through the whole runtime, and the same shot spoilt in every way that we know.
// The cases share the shot: rendering is what takes the time.
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/budget/heap_guard.h"
#include "tests/flow/armed_session.h"
#include "tests/flow/simulated_shot.h"
#include "tests/truth/random.h"

namespace roomcal::flow {
namespace {

// The bars for the stereo rig with an exact map.
constexpr double kMaxError_m = 0.15e-3;
const double kMaxError_rad = deg_to_rad(0.005);

class Shot : public testing::Test {
 protected:
  static void SetUpTestSuite() { shot_ = new SimulatedShot(simulate_shot("stereo_rig", 5, 5)); }
  static void TearDownTestSuite() { delete shot_; }

  /// A verdict that must not write, whose first reason holds `words`; and no camera pose out of nothing.
  static void expect_refusal(const std::vector<ImageView>& images, const map::RoomMap& map, const std::string& words) {
    ArmedSession armed(*shot_->device, map);
    ASSERT_TRUE(armed.calibrate(images).ok());
    EXPECT_FALSE(calib::may_write(armed.outcome().verdict));
    ASSERT_FALSE(armed.outcome().reasons.empty());
    const std::string reason(armed.outcome().reasons[0].view());
    EXPECT_NE(reason.find(words), std::string::npos) << reason;
  }

  static std::vector<ImageView> good_images() { return views(shot_->images); }
  static const map::RoomMap& map() { return shot_->map.map; }

  static SimulatedShot* shot_;
};

SimulatedShot* Shot::shot_ = nullptr;

TEST_F(Shot, Clean_MeetsTheTruth) {
  ArmedSession armed(*shot_->device, map());
  ASSERT_TRUE(armed.calibrate(good_images()).ok());
  const calib::Outcome& outcome = armed.outcome();
  ASSERT_EQ(outcome.verdict, calib::Verdict::kPass) << outcome.reasons[0].view();
  const SE3 T_rig_cam_true = shot_->T_room_cam_true[0].inverse() * shot_->T_room_cam_true[1];
  const Vec6 error = se3_log(outcome.cameras[1].T_rig_cam.inverse() * T_rig_cam_true);
  EXPECT_LE(error.head<3>().norm(), kMaxError_m);
  EXPECT_LE(error.tail<3>().norm(), kMaxError_rad);
  RecordProperty("error_um", std::to_string(1e6 * error.head<3>().norm()));
  RecordProperty("error_udeg", std::to_string(1e6 * rad_to_deg(error.tail<3>().norm())));
}

// What a checkerboard leaves of a real lens, said: the covariance covers what it does.
TEST_F(Shot, IntrinsicsOffByAThousandth_PassHonestlyWithTheirSigma) {
  calib::Device device = *shot_->device;
  for (calib::CameraSpec& camera : device.cameras) {
    camera::Intrinsics intrinsics = camera.camera.intrinsics();
    intrinsics.fx_px *= 1.001;
    intrinsics.fy_px *= 1.001;
    camera.camera = camera::Camera::create(intrinsics).value();
    camera.sigma_px = 0.2;
  }
  ArmedSession said(device, map());
  ASSERT_TRUE(said.calibrate(good_images()).ok());
  ASSERT_EQ(said.outcome().verdict, calib::Verdict::kPass) << said.outcome().reasons[0].view();
  const SE3 T_rig_cam_true = shot_->T_room_cam_true[0].inverse() * shot_->T_room_cam_true[1];
  const Vec6 error = se3_log(said.outcome().cameras[1].T_rig_cam.inverse() * T_rig_cam_true);
  EXPECT_LT(error.dot(said.outcome().cameras[1].cov_rig_cam.inverse() * error), 30);
}

/// The shot's device with lenses as an old calibration left them, and leave to refine them.
calib::Device with_lenses_off(const calib::Device& truth) {
  calib::Device device = truth;
  device.refine_intrinsics = true;
  for (calib::CameraSpec& camera : device.cameras) {
    camera::Intrinsics k = camera.camera.intrinsics();
    camera.intrinsics_sigma = camera::usual_sigma(k);
    k.fx_px *= 1.002;
    k.fy_px *= 1.002;
    k.cx_px += 1;
    k.cy_px -= 1;
    camera.camera = camera::Camera::create(k).value();
  }
  return device;
}

TEST_F(Shot, IntrinsicsOffAndRefined_MeetTheTruthWithinWhatTheyClaimAndWithoutHeap) {
  const calib::Device device = with_lenses_off(*shot_->device);
  ArmedSession armed(device, map());
  const std::vector<ImageView> images = good_images();
  Status status;
  [[maybe_unused]] std::size_t calls = 0;
  {
    const budget::HeapGuard guard;
    status = armed.calibrate(images);
    calls = guard.calls();
  }
  ASSERT_TRUE(status.ok()) << status.detail();
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_EQ(calls, 0U);
#endif
  const calib::Outcome& outcome = armed.outcome();
  ASSERT_EQ(outcome.verdict, calib::Verdict::kPass) << outcome.reasons[0].view();
  const SE3 T_rig_cam_true = shot_->T_room_cam_true[0].inverse() * shot_->T_room_cam_true[1];
  const Vec6 error = se3_log(outcome.cameras[1].T_rig_cam.inverse() * T_rig_cam_true);
  EXPECT_LT(error.dot(outcome.cameras[1].cov_rig_cam.inverse() * error), 30);
  EXPECT_LT(error.head<3>().norm(), 0.5e-3);
  for (std::size_t i = 0; i < 2; ++i) {
    const double true_fx_px = shot_->device->cameras[i].camera.intrinsics().fx_px;
    EXPECT_NEAR(outcome.cameras[i].camera.intrinsics().fx_px, true_fx_px, 2e-4 * true_fx_px);
    ASSERT_NE(outcome.solution.lens_of(outcome.cameras[i].view), nullptr);
    EXPECT_TRUE(outcome.solution.lens_of(outcome.cameras[i].view)->told_by_shot(0));
  }
  EXPECT_NEAR(outcome.held_out.median_sigmas, 1, 0.6);
}

TEST_F(Shot, Twice_GivesTheSameBytes) {
  ArmedSession first(*shot_->device, map()), second(*shot_->device, map());
  ASSERT_TRUE(first.calibrate(good_images()).ok());
  ASSERT_TRUE(second.calibrate(good_images()).ok());
  ASSERT_TRUE(second.calibrate(good_images()).ok());  // and a used arena is as good as a new one
  for (std::size_t i = 0; i < first.outcome().cameras.size(); ++i) {
    EXPECT_EQ(first.outcome().cameras[i].T_room_cam.matrix(), second.outcome().cameras[i].T_room_cam.matrix());
    EXPECT_EQ(first.outcome().cameras[i].cov_rig_cam, second.outcome().cameras[i].cov_rig_cam);
  }
}

TEST_F(Shot, ComputingIt_CallsNoHeap) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  ArmedSession armed(*shot_->device, map());
  const std::vector<ImageView> images = good_images();
  Status status;
  [[maybe_unused]] std::size_t calls = 0;
  {
    const budget::HeapGuard guard;
    status = armed.calibrate(images);
    calls = guard.calls();
  }
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(calls, 0u);
}

TEST_F(Shot, HeapGuard_SeesACallWhenThereIsOne) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  const budget::HeapGuard guard;
  const std::vector<int> numbers(1000, 1);
  EXPECT_GE(guard.calls(), 1u);
  EXPECT_EQ(numbers.back(), 1);
}

TEST_F(Shot, ArenasSmallerThanThePlan_AreOutOfMemoryAndNothingElse) {
  const calib::MemoryPlan plan = calib::plan_memory(*shot_->device, map());
  const std::vector<ImageView> images = good_images();
  std::vector<std::byte> permanent(plan.permanent_bytes), rest(plan.step_bytes + plan.scratch_bytes);
  Arena permanent_arena(permanent);
  const map::TriangleIndex index = map::TriangleIndex::build(map(), permanent_arena).value();
  const calib::Session session{*shot_->device, map(), index, {}};
  const tools::SteadyClock clock;
  const auto outcome = std::make_unique<calib::Outcome>();
  int refused = 0, done = 0;
  for (int percent = 0; percent <= 100; percent += 4) {
    for (const bool starve_step : {true, false}) {
      const auto part = static_cast<std::size_t>(percent);
      Arenas arenas;
      arenas.step = Arena(std::span(rest).first(starve_step ? plan.step_bytes * part / 100 : plan.step_bytes));
      arenas.scratch = Arena(
          std::span(rest).subspan(plan.step_bytes, starve_step ? plan.scratch_bytes : plan.scratch_bytes * part / 100));
      const Status status = calib::calibrate(session, calib::Shot{images, {}}, clock, arenas, *outcome);
      if (status.ok()) {
        EXPECT_EQ(outcome->verdict, calib::Verdict::kPass);
        ++done;
        continue;
      }
      EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
      EXPECT_EQ(outcome->verdict, calib::Verdict::kFailService);
      ++refused;
    }
  }
  EXPECT_GE(refused, 10);
  EXPECT_GE(done, 2);  // the plan itself is enough
}

TEST_F(Shot, CameraMissing_FailsButLocatesTheOther) {
  std::vector<ImageView> images = good_images();
  images[1] = {};
  expect_refusal(images, map(), "cam1: no image");
  ArmedSession armed(*shot_->device, map());
  ASSERT_TRUE(armed.calibrate(images).ok());
  EXPECT_TRUE(armed.outcome().cameras[0].located);
  EXPECT_FALSE(armed.outcome().cameras[1].located);
}

TEST_F(Shot, ReferenceMissing_GivesNoExtrinsics) {
  std::vector<ImageView> images = good_images();
  images[0] = {};
  expect_refusal(images, map(), "cam0: no image");
  ArmedSession armed(*shot_->device, map());
  ASSERT_TRUE(armed.calibrate(images).ok());
  EXPECT_TRUE(armed.outcome().cameras[1].located);
  EXPECT_FALSE(armed.outcome().cameras[1].in_rig);
}

TEST_F(Shot, BlackWhiteNoiseAndWrongSize_AreRefusedByName) {
  const cv::Size size = shot_->images[1].size();
  truth::Random random(3);
  cv::Mat noise(size, CV_8UC1);
  for (int i = 0; i < size.area(); ++i) noise.data[i] = static_cast<uint8_t>(random.uniform(0, 255));
  const std::vector<std::pair<cv::Mat, std::string>> cases = {
      {cv::Mat(size, CV_8UC1, cv::Scalar(2)), "cam1: mean level 2/255"},
      {cv::Mat(size, CV_8UC1, cv::Scalar(255)), "cam1: mean level 255/255"},
      {noise, "cam1: too few"},
      {cv::Mat(size / 2, CV_8UC1, cv::Scalar(90)), "cam1: image is 640x512"}};
  for (const auto& [image, words] : cases) {
    std::vector<ImageView> images = good_images();
    images[1] = tools::view(image);
    expect_refusal(images, map(), words);
  }
}

TEST_F(Shot, MapOfAnotherRoom_IsRefused) {
  const tools::LoadedMap other = simulated_map(6);
  expect_refusal(good_images(), other.map, "cam0: ");
}

TEST_F(Shot, MirroredImages_AreRefused) {
  std::vector<cv::Mat> mirrored;
  for (const cv::Mat& image : shot_->images) {
    cv::Mat flipped = image.clone();
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) flipped.at<uint8_t>(y, x) = image.at<uint8_t>(y, image.cols - 1 - x);
    mirrored.push_back(flipped);
  }
  expect_refusal(views(mirrored), map(), "cam0: ");
}

}  // namespace
}  // namespace roomcal::flow
