#include "tools/calibrate/report.h"

#include <cmath>
#include <string>

#include <Eigen/LU>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "tools/calibrate/draw_sweeps.h"
#include "tools/common/draw.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/image_io.h"

namespace roomcal::tools {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

struct Sigmas {
  double t_mm;
  double rot_deg;
};

/// Largest 1-sigma over the axes.
Sigmas sigmas(const Mat66& cov) {
  return {1e3 * std::sqrt(cov.topLeftCorner<3, 3>().diagonal().maxCoeff()),
          rad_to_deg(std::sqrt(cov.bottomRightCorner<3, 3>().diagonal().maxCoeff()))};
}

SE3 pose_from(const json& truth, const std::string& name) {
  Mat44 T;
  const json& rows = truth.at("T_room_sensor").at(name).at("T");
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      T(r, c) = rows.at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c)).get<double>();
  return SE3::from_matrix(T);
}

void print_truth_line(const calib::LocatedSensor& sensor, const SE3& T_rig_sensor_true) {
  const Vec6 error = se3_log(sensor.T_rig_sensor.inverse() * T_rig_sensor_true);
  const Sigmas sigma = sigmas(sensor.cov_rig_sensor);
  const double nees = error.dot(sensor.cov_rig_sensor.inverse() * error);
  fmt::print(
      "  {:<6} t = ({:9.3f} {:9.3f} {:9.3f}) mm   truth ({:9.3f} {:9.3f} {:9.3f})   error {:.3f} mm {:.4f} deg   "
      "sigma {:.3f} mm {:.4f} deg   NEES {:.1f}/6\n",
      sensor.name.view(), 1e3 * sensor.T_rig_sensor.t.x(), 1e3 * sensor.T_rig_sensor.t.y(),
      1e3 * sensor.T_rig_sensor.t.z(), 1e3 * T_rig_sensor_true.t.x(), 1e3 * T_rig_sensor_true.t.y(),
      1e3 * T_rig_sensor_true.t.z(), 1e3 * error.head<3>().norm(), rad_to_deg(error.tail<3>().norm()), sigma.t_mm,
      sigma.rot_deg, nees);
}

void print_lidar(const calib::LidarOutcome& lidar) {
  const scan::Location& location = lidar.location;
  fmt::print("  {:<6} {} of {} sweeps, {} of {} points are inliers", lidar.name.view(), lidar.used_sweeps, lidar.sweeps,
             location.inliers, location.points);
  if (lidar.located) fmt::print(", {:.1f} mm rms", 1e3 * location.rms_m);
  if (lidar.in_rig) {
    const Sigmas sigma = sigmas(lidar.cov_rig_lidar);
    fmt::print(", sigma {:.2f} mm {:.3f} deg", sigma.t_mm, sigma.rot_deg);
  }
  fmt::print("\n");
  for (const scan::WeakDirection& weak : location.weak)
    if (lidar.located) fmt::print("         {}\n", scan::describe(weak).view());
}

/// "fx_px 612.31 +- 0.21 (given 613.42 +- 1.22)"; what the shot does not tell is left out.
void print_lens(const rig::RefinedLens& lens) {
  const camera::Parameters refined = camera::parameters_of(lens.camera.intrinsics());
  std::string told, untold;
  for (std::size_t k = 0; k < camera::kParameterNames.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (lens.told_by_shot(i))
      told += fmt::format("         {} {:.6g} +- {:.2g} (given {:.6g} +- {:.2g})\n", camera::kParameterNames[k],
                          refined[i], lens.sigma[i], lens.prior[i], lens.prior_sigma[i]);
    else
      untold += fmt::format(" {}", camera::kParameterNames[k]);
  }
  fmt::print("{}", told);
  if (!untold.empty()) fmt::print("         as given, for this shot tells no more:{}\n", untold);
}

void print_installed(const calib::InstalledCheck& check) {
  if (!check.done) return;
  fmt::print("against the installed record: {}, p {:.2g}\n",
             check.moved ? fmt::format("{} has moved", check.moved_sensor.view()) : "nothing has moved", check.p_value);
  for (const calib::SensorChange& change : check.sensors) {
    if (!change.comparable) {
      fmt::print("  {:<6} not in this shot\n", change.name.view());
      continue;
    }
    const Sigmas sigma = sigmas(change.cov);
    fmt::print("  {:<6} {:.3f} mm {:.4f} deg, sigma {:.3f} mm {:.4f} deg, p {:.2g}\n", change.name.view(),
               1e3 * change.delta.head<3>().norm(), rad_to_deg(change.delta.tail<3>().norm()), sigma.t_mm,
               sigma.rot_deg, change.p_value);
  }
}

const cv::Scalar kResidualColour(60, 60, 255);
constexpr double kResidualMagnification = 200;  // residuals are hundredths of a pixel: unseen at true size

void draw_residuals(const calib::CameraOutcome& camera, const camera::Camera& model, const map::RoomMap& map,
                    cv::Mat& picture) {
  const int thickness = std::max(1, picture.cols / 1200);
  const SE3 T_cam_room = camera.T_room_cam.inverse();
  for (const pose::Correspondence& inlier : camera.inliers) {
    Vec2 predicted_px;
    if (!model.project(T_cam_room * map.marker(inlier.marker).p_room, predicted_px).ok()) continue;
    const Vec2 seen_px = camera.detections[inlier.observation].centre_px;
    const Vec2 tip_px = seen_px + kResidualMagnification * (predicted_px - seen_px);
    cv::line(picture, cv::Point2d(seen_px.x(), seen_px.y()), cv::Point2d(tip_px.x(), tip_px.y()), kResidualColour,
             thickness, cv::LINE_AA);
    cv::putText(picture, std::to_string(map.marker(inlier.marker).id), cv::Point2d(seen_px.x() + 6, seen_px.y() - 6),
                cv::FONT_HERSHEY_SIMPLEX, 0.4 * thickness, cv::Scalar(255, 220, 80), thickness, cv::LINE_AA);
  }
}

}  // namespace

void print_outcome(const calib::Outcome& outcome, std::size_t arena_peak_bytes) {
  fmt::print("{}\n", calib::to_string(outcome.verdict));
  for (const Reason& reason : outcome.reasons) fmt::print("  {}\n", reason.view());
  fmt::print("rig frame: {}\n", outcome.cameras[outcome.reference].name.view());
  for (const calib::CameraOutcome& camera : outcome.cameras) {
    fmt::print("  {:<6} {} of {} usable markers are inliers", camera.name.view(), camera.inliers.size(),
               camera.usable_detections);
    if (camera.located) fmt::print(", {:.3f} px rms, coverage {:.0f} %", camera.rms_px, 100 * camera.coverage);
    if (camera.in_rig) {
      const Sigmas sigma = sigmas(camera.cov_rig_cam);
      fmt::print(", sigma {:.3f} mm {:.4f} deg", sigma.t_mm, sigma.rot_deg);
    }
    fmt::print("\n");
    if (const rig::RefinedLens* lens = camera.located ? outcome.solution.lens_of(camera.view) : nullptr)
      print_lens(*lens);
  }
  for (const calib::LidarOutcome& lidar : outcome.lidars) print_lidar(lidar);
  if (outcome.held_out.markers > 0)
    fmt::print("held-out markers: {}, missed by {:.2f} sigma\n", outcome.held_out.markers,
               outcome.held_out.median_sigmas);
  print_installed(outcome.installed);
  fmt::print("time:");
  for (std::size_t s = 0; s < outcome.stage_ns.size(); ++s)
    fmt::print(" {} {:.2f} ms", calib::to_string(static_cast<calib::Stage>(s)),
               1e-6 * static_cast<double>(outcome.stage_ns[s]));
  fmt::print("; arena peak {:.2f} MiB\n", static_cast<double>(arena_peak_bytes) / (1 << 20));
}

void print_against_truth(const calib::Outcome& outcome, const fs::path& truth_file) {
  const calib::CameraOutcome& reference = outcome.cameras[outcome.reference];
  fmt::print("T_rig_sensor beside the truth:\n");
  try {
    const json truth = json::parse(read_text(truth_file));
    const SE3 T_rig_room = pose_from(truth, std::string(reference.name.view())).inverse();
    for (const calib::LocatedSensor& sensor : calib::located_sensors(outcome)) {
      const std::string name(sensor.name.view());
      if (sensor.in_rig && name != reference.name.view() && truth.at("T_room_sensor").contains(name))
        print_truth_line(sensor, T_rig_room * pose_from(truth, name));
    }
  } catch (const json::exception& error) {
    throw ToolError(truth_file.string() + ": is not the truth of this shot: " + error.what());
  }
}

void draw_outcome(const calib::Outcome& outcome, const map::RoomMap& map, const ShotFolder& shot,
                  const fs::path& folder) {
  make_folder(folder);
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    if (shot.images[i].empty()) continue;
    const calib::CameraOutcome& camera = outcome.cameras[i];
    cv::Mat picture = canvas(shot.images[i]);
    draw_detections(picture, camera.detections);
    if (camera.located) draw_residuals(camera, camera.camera, map, picture);
    write_image(folder / (std::string(camera.name.view()) + "_calibrated.png"), picture);
  }
  draw_sweeps(outcome, map, shot, folder);
}

}  // namespace roomcal::tools
