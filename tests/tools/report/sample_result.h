#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/math/se3.h"
#include "tools/common/matrix_json.h"

namespace roomcal::tools::test {

inline nlohmann::json sample_intrinsics() {
  return {{"model", "pinhole_radtan"},
          {"width_px", 640},
          {"height_px", 480},
          {"fx_px", 500.0},
          {"fy_px", 500.0},
          {"cx_px", 320.0},
          {"cy_px", 240.0},
          {"distortion", {0.0, 0.0, 0.0, 0.0}}};
}

/// A result as `roomcal calibrate --json` writes it: cameras cam0 (the reference), cam1, ... with these places in the
/// room, each known to 0.1 mm and 0.1 mrad.
inline nlohmann::json sample_result(const std::vector<SE3>& T_room_cam) {
  nlohmann::json sensors = nlohmann::json::object();
  for (std::size_t i = 0; i < T_room_cam.size(); ++i) {
    const SE3 T_rig_cam = i == 0 ? SE3() : T_room_cam[0].inverse() * T_room_cam[i];
    const Mat66 cov = i == 0 ? Mat66(Mat66::Zero()) : Mat66(1e-8 * Mat66::Identity());
    sensors["cam" + std::to_string(i)] = {{"kind", "camera"},
                                          {"located", true},
                                          {"intrinsics", sample_intrinsics()},
                                          {"T_room_sensor", rows_of(T_room_cam[i].matrix())},
                                          {"T_rig_sensor", rows_of(T_rig_cam.matrix())},
                                          {"covariance", rows_of(cov)},
                                          {"detections", 41},
                                          {"inliers", 39},
                                          {"rms_px", 0.02},
                                          {"coverage", 1.0}};
  }
  return {{"verdict", "PASS"},  {"reasons", nlohmann::json::array()},    {"rig_frame", "cam0"},
          {"device", "sample"}, {"map", {{"id", "room"}, {"hash", ""}}}, {"sensors", std::move(sensors)}};
}

inline std::vector<SE3> sample_places() {
  return {SE3{so3_exp(Vec3(0.1, -0.4, 0.2)), Vec3(1.0, 1.2, 1.1)},
          SE3{so3_exp(Vec3(0.3, 0.9, -0.2)), Vec3(1.1, 1.3, 1.0)},
          SE3{so3_exp(Vec3(-0.5, 0.2, 1.4)), Vec3(0.9, 1.2, 1.2)}};
}

}  // namespace roomcal::tools::test
