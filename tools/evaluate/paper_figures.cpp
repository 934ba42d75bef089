#include "tools/evaluate/paper_figures.h"

#include <algorithm>

namespace roomcal::tools {

namespace {

struct Measured {
  const char* device;
  MountingEdge edge;
};

/// T_to_from as the paper measured it from one shot, in metres.
const std::vector<Measured>& measured() {
  static const std::vector<Measured> rows = {
      {"tls", {"cam1", "cam0", {27.69, 0.27, 0.29}, {0.0004, 0.0275, 0.0061}}},
      {"tls", {"lidar0", "cam0", {-13.87, 0.79, 0.05}, {0.0002, -0.0196, 0.0208}}},
      {"backpack", {"cam1", "cam0", {0.18, -90.16, 0.49}, {-0.0281, 0.0001, -0.0309}}},
      {"backpack", {"cam2", "cam0", {0.09, -179.82, 0.26}, {0.0026, 0.0002, -0.0588}}},
      {"backpack", {"cam3", "cam0", {0.23, 89.78, 0.11}, {0.0307, 0.0001, -0.0282}}},
      {"backpack", {"lidar0", "cam0", {-1.34, -14.66, 88.12}, {0.6357, 0.0030, -0.0503}}},
      {"backpack", {"lidar1", "lidar0", {1.41, -75.58, -31.39}, {-0.2164, 0.1262, -0.3428}}},
      {"mobile_robot", {"cam1", "cam0", {0.29, 90.36, 0.43}, {0.0561, 0.0003, 0.0536}}},
      {"mobile_robot", {"cam2", "cam0", {0.32, 179.86, 0.05}, {0.0024, 0.0006, -0.1102}}},
      {"mobile_robot", {"cam3", "cam0", {0.30, -89.41, 0.11}, {-0.0542, 0.0003, -0.0542}}},
      {"mobile_robot", {"lidar0", "cam0", {89.77, -45.18, 0.30}, {0.0063, -0.0665, -0.0493}}}};
  return rows;
}

PoseDistance robot_lidar_distance(const Vec3& euler_xyz_deg, const Vec3& t_m) {
  const MountingEdge drawn{"lidar0", "cam0", {90, -45, 0}, {0, -0.0593, -0.05497}};
  return distance_between(MountingEdge{"lidar0", "cam0", euler_xyz_deg, t_m}.T_to_from(), drawn.T_to_from());
}

double backpack_lidars_distance(const Vec3& t_m) { return (t_m - Vec3(-0.2255, 0.1302, -0.3492)).norm(); }

}  // namespace

PoseDistance distance_between(const SE3& T_a, const SE3& T_b) {
  return {(T_a.t - T_b.t).norm(), rotation_angle_between(T_a.R, T_b.R)};
}

std::optional<PoseDistance> paper_distance(const PaperDevice& device, const std::string& to, const std::string& from) {
  const auto is_pair = [&](const MountingEdge& edge) { return edge.to == to && edge.from == from; };
  const auto row = std::find_if(measured().begin(), measured().end(),
                                [&](const Measured& m) { return m.device == device.name && is_pair(m.edge); });
  const auto drawn = std::find_if(device.edges.begin(), device.edges.end(), is_pair);
  if (row == measured().end() || drawn == device.edges.end()) return std::nullopt;
  return distance_between(row->edge.T_to_from(), drawn->T_to_from());
}

const std::vector<PaperNoiseRow>& paper_noise_rows() {
  static const std::vector<PaperNoiseRow> rows = {
      {0, 0.00016, 0.47, robot_lidar_distance({90.23, -45.23, 0.27}, {0.0081, -0.0666, -0.0458}),
       backpack_lidars_distance({-0.2259, 0.1248, -0.3386})},
      {0.005, 0.00082, 1.58, robot_lidar_distance({90.8, -44.83, 0.34}, {0.0145, -0.0580, -0.0453}),
       backpack_lidars_distance({-0.2230, 0.1239, -0.3396})},
      {0.010, 0.00947, 1.97, robot_lidar_distance({90.17, -45.76, 0.71}, {0.0216, -0.0500, -0.0556}),
       backpack_lidars_distance({-0.2002, 0.1238, -0.3507})}};
  return rows;
}

}  // namespace roomcal::tools
