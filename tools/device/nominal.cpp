#include "tools/device/nominal.h"

#include <cmath>
#include <deque>
#include <map>

#include <Eigen/LU>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

using Json = nlohmann::json;

constexpr double kRotationTolerance = 1e-4;

struct Edge {
  std::string to, from;
  SE3 T_to_from;
};

class NominalReader {
 public:
  NominalReader(const std::string& where, const std::string& text) : where_(where) {
    try {
      root_ = Json::parse(text);
    } catch (const Json::exception& error) {
      throw ToolError(fmt::format("{}: not JSON: {}", where, error.what()));
    }
    if (!root_.is_object()) throw ToolError(where + ": expected an object with `edges`; is this a nominal file?");
  }

  [[noreturn]] void fail(const std::string& path, const std::string& message) const {
    throw ToolError(fmt::format("{}: {}: {}", where_, path, message));
  }

  const Json& root() const { return root_; }

  const Json& field(const Json& object, const std::string& key, const std::string& path) const {
    if (!object.is_object() || !object.contains(key)) fail(path, fmt::format("`{}` is missing; add it", key));
    return object.at(key);
  }
  std::string text(const Json& object, const std::string& key, const std::string& path) const {
    const Json& value = field(object, key, path);
    if (!value.is_string()) fail(path + "." + key, "expected a text");
    return value.get<std::string>();
  }
  double number(const Json& value, const std::string& path) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail(path, "expected a finite number");
    return value.get<double>();
  }
  const Json& list(const Json& object, const std::string& key, const std::string& path) const {
    const Json& value = field(object, key, path);
    if (!value.is_array()) fail(path + "." + key, "expected a list");
    return value;
  }

  SE3 transform(const Json& rows, const std::string& path) const {
    Mat44 T;
    if (!rows.is_array() || rows.size() != 4) fail(path, "expected four rows of four numbers");
    for (std::size_t row = 0; row < 4; ++row) {
      if (!rows[row].is_array() || rows[row].size() != 4) fail(path, "expected four rows of four numbers");
      for (std::size_t column = 0; column < 4; ++column) {
        T(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = number(rows[row][column], path);
      }
    }
    const Mat33 R = T.topLeftCorner<3, 3>();
    if ((T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 0 || R.cwiseAbs().maxCoeff() > 2 ||
        (R * R.transpose() - Mat33::Identity()).norm() > kRotationTolerance || R.determinant() < 0) {
      fail(path, "not a rigid transform; the rotation needs six digits at least, the last row 0 0 0 1");
    }
    return SE3::from_matrix(T);
  }

  std::vector<Edge> edges() const {
    std::vector<Edge> edges;
    for (const Json& edge : list(root_, "edges", "nominal")) {
      const std::string path = fmt::format("edges[{}]", edges.size());
      edges.push_back(
          {text(edge, "to", path), text(edge, "from", path), transform(field(edge, "T", path), path + ".T")});
    }
    return edges;
  }

 private:
  const std::string& where_;
  Json root_;
};

struct Mount {
  SE3 T_rig_sensor;
  int edges = 0;
};

/// Breadth first from the rig frame, so that every sensor gets its shortest chain.
std::map<std::string, Mount> compose(const std::vector<Edge>& edges, const std::string& rig_frame) {
  std::map<std::string, Mount> mounts{{rig_frame, {}}};
  std::deque<std::string> open{rig_frame};
  while (!open.empty()) {
    const std::string here = open.front();
    open.pop_front();
    const Mount mount = mounts.at(here);
    for (const Edge& edge : edges) {
      if (edge.from == here && !mounts.contains(edge.to)) {
        mounts[edge.to] = {mount.T_rig_sensor * edge.T_to_from.inverse(), mount.edges + 1};
        open.push_back(edge.to);
      }
      if (edge.to == here && !mounts.contains(edge.from)) {
        mounts[edge.from] = {mount.T_rig_sensor * edge.T_to_from, mount.edges + 1};
        open.push_back(edge.from);
      }
    }
  }
  return mounts;
}

void add_lidars(const NominalReader& reader, Device& device) {
  if (!reader.root().contains("lidars")) return;
  std::size_t i = 0;
  for (const Json& lidar : reader.list(reader.root(), "lidars", "nominal")) {
    const std::string path = fmt::format("lidars[{}]", i++);
    Sensor sensor;
    sensor.name = reader.text(lidar, "name", path);
    sensor.kind = SensorKind::kLidar;
    sensor.lidar_model = reader.text(lidar, "kind", path);
    if (lidar.contains("file")) sensor.file = reader.text(lidar, "file", path);
    if (device.find(sensor.name) != nullptr)
      reader.fail(path, fmt::format("`{}` stands already; rename one", sensor.name));
    device.sensors.push_back(std::move(sensor));
  }
}

void check_cameras(const NominalReader& reader, const Device& device) {
  if (!reader.root().contains("cameras")) return;
  for (const Json& name : reader.list(reader.root(), "cameras", "nominal")) {
    if (!name.is_string()) reader.fail("cameras", "expected a list of names");
    if (device.find(name.get<std::string>()) == nullptr) {
      reader.fail("cameras",
                  fmt::format("`{}` is not in the camchain; add it there or remove it here", name.get<std::string>()));
    }
  }
}

}  // namespace

void apply_nominal(const std::string& where, const std::string& text, Device& device) {
  const NominalReader reader(where, text);
  check_cameras(reader, device);
  add_lidars(reader, device);
  const double sigma_t_m =
      reader.number(reader.field(reader.root(), "sigma_t_m_per_axis", "nominal"), "sigma_t_m_per_axis");
  const double sigma_rot_rad = deg_to_rad(
      reader.number(reader.field(reader.root(), "sigma_rot_deg_per_axis", "nominal"), "sigma_rot_deg_per_axis"));
  const std::vector<Edge> edges = reader.edges();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (const std::string& name : {edges[i].to, edges[i].from}) {
      if (device.find(name) == nullptr)
        reader.fail(fmt::format("edges[{}]", i), fmt::format("no sensor `{}`; list it", name));
    }
  }
  const std::map<std::string, Mount> mounts = compose(edges, device.rig_frame);
  for (Sensor& sensor : device.sensors) {
    sensor.nominal.reset();
    if (sensor.name == device.rig_frame) continue;
    const auto mount = mounts.find(sensor.name);
    if (mount == mounts.end()) {
      reader.fail("edges",
                  fmt::format("none connects `{}` to the rig frame `{}`; add one", sensor.name, device.rig_frame));
    }
    const double chain = std::sqrt(mount->second.edges);
    sensor.nominal = NominalMount{mount->second.T_rig_sensor, chain * sigma_t_m, chain * sigma_rot_rad};
  }
  if (reader.root().contains("device")) device.name = reader.text(reader.root(), "device", "nominal");
  check_device(device, where);
}

}  // namespace roomcal::tools
