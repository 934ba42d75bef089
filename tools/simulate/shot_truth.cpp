#include "tools/simulate/shot_truth.h"

#include <fmt/core.h>

#include "tools/simulate/json_geometry.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

json camera_names(const Stand& stand) {
  json names = json::array();
  for (const TrueCamera& camera : stand.cameras) names.push_back(camera.name);
  return names;
}

json lidar_list(const Stand& stand) {
  json list = json::array();
  for (const TrueLidar& lidar : stand.lidars)
    list.push_back({{"name", lidar.name}, {"kind", lidar.kind}, {"file", file_of(lidar)}});
  return list;
}

json nominal_edge(const MountingEdge& edge) {
  json node = json_of(edge.T_to_from());
  node["to"] = edge.to;
  node["from"] = edge.from;
  node["tabulated"] = {
      {"euler_xyz_deg", json_of(edge.euler_xyz_deg)}, {"t_m", json_of(edge.t_m)}, {"read_as", "T_to_from"}};
  return node;
}

json truth_of_marker(const MarkerTruth& marker) {
  return {{"id", marker.id},
          {"uv", json_of(marker.uv_px)},
          {"ellipse_center", json_of(marker.outer.centre_px)},
          {"major_px", marker.outer.major_px},
          {"minor_px", marker.outer.minor_px},
          {"angle_deg", rad_to_deg(marker.outer.angle_rad)},
          {"slant_deg", rad_to_deg(marker.slant_rad)},
          {"distance_m", marker.distance_m},
          {"visible", marker.visible}};
}

json truth_of_picture(const TrueCamera& camera, const Picture& picture, const ShotOptions& options) {
  json markers = json::array();
  int usable = 0;
  for (const MarkerTruth& marker : picture.markers) {
    markers.push_back(truth_of_marker(marker));
    usable += marker.visible == 1 && marker.outer.major_px >= 12 ? 1 : 0;
  }
  const camera::Intrinsics& lens = camera.camera.intrinsics();
  return {{"resolution", {lens.width_px, lens.height_px}},
          {"markers_usable_12px", usable},
          {"image",
           {{"grey_per_radiance", picture.sensor.grey_per_radiance},
            {"gamma", 1.0},
            {"psf_sigma_px", options.blur_px},
            {"motion_px", options.motion_px},
            {"defocus_px", options.defocus_px},
            {"vignetting", options.vignetting},
            {"noise_mid", options.noise_sigma}}},
          {"markers", markers}};
}

json truth_of_lidar(const TrueLidar& lidar, const LidarRecording& recording, const LidarOptions& options) {
  json node = {{"kind", lidar.kind},
               {"unit", lidar.unit},
               {"sigma_m", lidar.sigma_m},
               {"dropout", options.dropout},
               {"mixed_pixels", options.mixed_pixels},
               {"returns", recording.returns}};
  if (lidar.unit == kTlsKind) {
    node["step_deg"] = rad_to_deg(options.tls_step_rad);
  } else {
    node["spins"] = options.sweeps;
    node["laser_bias_m"] = lidar.beam_offset_m;
  }
  return node;
}

json extrinsics_json(const Stand& stand) {
  json all = json::array();
  for (const auto& [to, T_room_to] : sensor_poses(stand)) {
    for (const auto& [from, T_room_from] : sensor_poses(stand)) {
      if (to == from) continue;
      json node = json_of(T_room_to.inverse() * T_room_from);
      node["to"] = to;
      node["from"] = from;
      all.push_back(node);
    }
  }
  return all;
}

json perturbation_json(const Stand& stand) {
  json all = json::array();
  for (std::size_t i = 0; i < stand.perturbations.size(); ++i) {
    const Perturbation& drawn = stand.perturbations[i];
    all.push_back({{"to", stand.device->edges[i].to},
                   {"from", stand.device->edges[i].from},
                   {"rotvec_deg", json_of(Vec3(drawn.rotvec_rad * rad_to_deg(1)))},
                   {"dt_m", json_of(drawn.dt_m)},
                   {"rule", "T_to_from = [exp(rotvec) R_nominal | t_nominal + dt]"}});
  }
  return all;
}

json truth_of_imu(const TrueImu& imu) {
  return {{"T_room_imu", json_of(imu.T_room_imu)},           {"accel_bias_mps2", json_of(imu.accel_bias_mps2)},
          {"gyro_bias_radps", json_of(imu.gyro_bias_radps)}, {"accel_sigma_mps2", imu.accel_sigma_mps2},
          {"gyro_sigma_radps", imu.gyro_sigma_radps},        {"gravity_mps2", kGravity_mps2}};
}

}  // namespace

json nominal_json(const Stand& stand, const ShotOptions& options) {
  json edges = json::array();
  for (const MountingEdge& edge : stand.device->edges) edges.push_back(nominal_edge(edge));
  json imus = json::array();
  if (stand.imu) {
    imus.push_back(nominal_edge(imu_mounting()));
    imus.back()["name"] = stand.imu->name;
    imus.back()["file"] = stand.imu->name + ".csv";
  }
  return {{"device", stand.device->name},
          {"imus", imus},
          {"convention",
           "T maps points of frame 'from' to frame 'to' (X_to = R X_from + t); R = Rz(c) Ry(b) Rx(a) from "
           "euler_xyz_deg = (a,b,c). Camera: x right, y down, z forward. LiDAR: as its packets, see CONVENTIONS.md; "
           "a scanner (tls) as a camera."},
          {"cameras", camera_names(stand)},
          {"lidars", lidar_list(stand)},
          {"sigma_rot_deg_per_axis", options.sigma_rot_deg},
          {"sigma_t_m_per_axis", options.sigma_t_m},
          {"edges", edges}};
}

json truth_json(const Scene& scene, const Stand& stand, const ShotFacts& facts, const ShotOptions& options) {
  json node = {{"format", "twin-truth-1"},
               {"device", stand.device->name},
               {"room", fmt::format("simulated, seed {}", scene.seed)},
               {"seed", options.seed},
               {"conventions",
                {{"T_a_b", "maps points of frame b to frame a (X_a = R X_b + t); 4x4 row-major"},
                 {"pixels", "(0,0) is the centre of the top-left pixel"},
                 {"uv", "projection of the true 3-D marker centre (not the centre of the ellipse)"},
                 {"ellipse", "major_px/minor_px are full axes of the projected outer circle"},
                 {"visible", "fraction of the outer disc inside the image and not hidden by an object"}}},
               {"extrinsics", extrinsics_json(stand)},
               {"perturbation", perturbation_json(stand)}};
  for (const auto& [name, T_room_sensor] : sensor_poses(stand)) node["T_room_sensor"][name] = json_of(T_room_sensor);
  for (std::size_t i = 0; i < stand.cameras.size(); ++i)
    node["cameras"][stand.cameras[i].name] = truth_of_picture(stand.cameras[i], facts.pictures[i], options);
  for (std::size_t i = 0; i < stand.lidars.size(); ++i)
    node["lidars"][stand.lidars[i].name] = truth_of_lidar(stand.lidars[i], facts.recordings[i], options.lidar);
  if (stand.imu) node["imus"][stand.imu->name] = truth_of_imu(*stand.imu);
  return node;
}

}  // namespace roomcal::tools
