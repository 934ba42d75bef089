// The terrestrial scanner as a device, one press: the cameras find the room and the scanner's sweep is that room.

#include <gtest/gtest.h>

#include "tests/board/tls_bench.h"

namespace roomcal::board {
namespace {

TEST(TlsBoard, OnePress_FindsScannerAndCameras) {
  test::TlsBench bench(4);
  ASSERT_TRUE(bench.trouble().empty()) << bench.trouble().view();
  const press::Report& report = bench.press(press::Kind::kCalibrate);
  for (const Reason& reason : report.reasons) std::printf("%s\n", std::string(reason.view()).c_str());
  ASSERT_TRUE(bench.machine().press()->has_outcome());
  EXPECT_TRUE(report.stored) << to_string(report.result);
  const calib::Outcome& outcome = bench.machine().press()->outcome();
  ASSERT_TRUE(outcome.lidars[0].in_rig) << outcome.lidars[0].failure.view();
  EXPECT_GT(outcome.lidars[0].location.points, 100'000U);
  const SE3 T_cam_lidar = bench.stand().cameras[0].T_room_cam.inverse() * bench.stand().lidars[0].T_room_lidar;
  const Vec6 error = se3_log(outcome.lidars[0].T_rig_lidar.inverse() * T_cam_lidar);
  std::printf("TLS: camera to scanner %.2f mm, %.4f deg from the truth\n", 1e3 * error.head<3>().norm(),
              rad_to_deg(error.tail<3>().norm()));
  EXPECT_LT(error.head<3>().norm(), 0.003);
  EXPECT_LT(rad_to_deg(error.tail<3>().norm()), 0.05);
}

}  // namespace
}  // namespace roomcal::board
