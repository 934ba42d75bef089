#include "tools/calibrate/outcome_detail.h"

#include <algorithm>
#include <string>
#include <vector>

#include "runtime/rig/reprojection.h"
#include "tools/common/detection_json.h"
#include "tools/common/matrix_json.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

json triangle(const Mat22& cov) { return {cov(0, 0), cov(0, 1), cov(1, 1)}; }

bool is_held_out(const calib::CameraOutcome& camera, uint16_t marker) {
  const auto held_out = camera.rings.subspan(camera.kept_rings);
  return std::any_of(held_out.begin(), held_out.end(),
                     [&](const rig::RingObservation& ring) { return ring.landmark == marker; });
}

void add_inlier(const calib::Session& session, const calib::CameraOutcome& camera, const pose::Correspondence& inlier,
                json& ring) {
  const marker::Detection& seen = camera.detections[inlier.observation];
  const map::MapMarker marker = session.map.marker(inlier.marker);
  rig::Reprojection predicted;
  if (!rig::reproject(camera.camera, camera.T_room_cam, marker.p_room, seen.centre_px, predicted).ok()) return;
  const double floor_px2 = session.sigma_floor_px * session.sigma_floor_px;
  const Mat22 of_map = predicted.J_point * marker.cov_m2 * predicted.J_point.transpose();
  const Vec2 at_px = seen.centre_px + predicted.residual_px;
  ring["marker"] = marker.id;
  ring["predicted_px"] = {at_px.x(), at_px.y()};
  ring["residual_cov_px2"] = triangle(seen.cov_px2 + of_map + floor_px2 * Mat22::Identity());
  ring["held_out"] = is_held_out(camera, inlier.marker);
}

json rings_of(const calib::Session& session, const calib::CameraOutcome& camera) {
  json rings = json::array();
  for (const marker::Detection& detection : camera.detections) rings.push_back(to_json(detection));
  if (!camera.located) return rings;
  for (const pose::Correspondence& inlier : camera.inliers)
    add_inlier(session, camera, inlier, rings[inlier.observation]);
  return rings;
}

void add_nominal(const calib::NominalMounting& mounting, json& sensor) {
  if (!mounting.known) return;
  sensor["nominal"] = {{"T_rig_sensor", rows_of(mounting.T_rig_sensor.matrix())},
                       {"sigma_t_m", mounting.sigma_t_m},
                       {"sigma_rot_rad", mounting.sigma_rot_rad}};
}

/// With xi_rig = xi_sensor - Ad(T_sensor_reference) xi_reference to first order, all sensors at once.
json joint_covariance(const calib::Outcome& outcome) {
  const calib::CameraOutcome& reference = outcome.cameras[outcome.reference];
  std::vector<calib::LocatedSensor> sensors;
  for (const calib::LocatedSensor& sensor : calib::located_sensors(outcome))
    if (sensor.in_rig && sensor.name.view() != reference.name.view()) sensors.push_back(sensor);
  const rig::RigSolution& solution = outcome.solution;
  const std::size_t r = reference.view;
  Eigen::MatrixXd joint(6 * sensors.size(), 6 * sensors.size());
  json names = json::array();
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const std::size_t a = sensors[i].number;
    const Mat66 Ad_a = se3_adjoint(sensors[i].T_rig_sensor.inverse());
    names.push_back(std::string(sensors[i].name.view()));
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      const std::size_t b = sensors[k].number;
      const Mat66 Ad_b = se3_adjoint(sensors[k].T_rig_sensor.inverse());
      joint.block<6, 6>(static_cast<Eigen::Index>(6 * i), static_cast<Eigen::Index>(6 * k)) =
          solution.cov_block(a, b) - Ad_a * solution.cov_block(r, b) - solution.cov_block(a, r) * Ad_b.transpose() +
          Ad_a * solution.cov_block(r, r) * Ad_b.transpose();
    }
  }
  return {{"sensors", std::move(names)}, {"matrix", rows_of(joint)}};
}

}  // namespace

void add_detail(const calib::Session& session, const calib::Outcome& outcome, json& result) {
  json& sensors = result.at("sensors");
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    json& sensor = sensors.at(std::string(outcome.cameras[i].name.view()));
    sensor["rings"] = rings_of(session, outcome.cameras[i]);
    add_nominal(session.device.cameras[i].nominal, sensor);
  }
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i)
    add_nominal(session.device.lidars[i].nominal, sensors.at(std::string(outcome.lidars[i].name.view())));
  const calib::CameraOutcome& reference = outcome.cameras[outcome.reference];
  if (reference.in_rig && calib::located_sensors(outcome).size() > 1)
    result["joint_covariance"] = joint_covariance(outcome);
}

}  // namespace roomcal::tools
