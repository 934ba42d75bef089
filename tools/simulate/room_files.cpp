#include "tools/simulate/room_files.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/simulate/json_geometry.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/room_walls.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

constexpr const char* kFormat = "roomcal-simulated-room-2";

json to_json(const Decal& decal) {
  return {{"print", static_cast<int>(decal.print)}, {"id", decal.marker_id},
          {"centre", json_of(decal.centre)},        {"angle_rad", decal.angle_rad},
          {"half_size", json_of(decal.half_size)},  {"radius", decal.radius_m}};
}

Decal decal_of(const json& node) {
  const int print = node.at("print").get<int>();
  if (print < 0 || print > static_cast<int>(Print::kStripes))
    throw ToolError(fmt::format("print {} is unknown", print));
  Decal decal;
  decal.print = static_cast<Print>(print);
  decal.marker_id = node.at("id").get<int>();
  decal.centre = vector_of<2>(node.at("centre"));
  decal.angle_rad = node.at("angle_rad").get<double>();
  decal.half_size = vector_of<2>(node.at("half_size"));
  decal.radius_m = node.at("radius").get<double>();
  return decal;
}

json to_json(const Plane& plane) {
  json decals = json::array();
  for (const Decal& decal : plane.decals) decals.push_back(to_json(decal));
  json waves = json::array();
  for (const Wave& wave : plane.waves)
    waves.push_back(
        {{"rad_per_m", json_of(wave.rad_per_m)}, {"phase_rad", wave.phase_rad}, {"amplitude_m", wave.amplitude_m}});
  return {{"name", plane.name},
          {"origin", json_of(plane.origin)},
          {"u", json_of(plane.axis_u)},
          {"v", json_of(plane.axis_v)},
          {"normal", json_of(plane.normal)},
          {"size", json_of(plane.size)},
          {"albedo", plane.albedo},
          {"tile", plane.tile_m},
          {"bounded", plane.bounded},
          {"waves", waves},
          {"decals", decals}};
}

Plane plane_of(const json& node) {
  Plane plane;
  plane.name = node.at("name").get<std::string>();
  plane.origin = vector_of<3>(node.at("origin"));
  plane.axis_u = vector_of<3>(node.at("u"));
  plane.axis_v = vector_of<3>(node.at("v"));
  plane.normal = vector_of<3>(node.at("normal"));
  plane.size = vector_of<2>(node.at("size"));
  plane.albedo = node.at("albedo").get<double>();
  plane.tile_m = node.at("tile").get<double>();
  plane.bounded = node.at("bounded").get<bool>();
  for (const json& wave : node.at("waves"))
    plane.waves.push_back(
        {vector_of<2>(wave.at("rad_per_m")), wave.at("phase_rad").get<double>(), wave.at("amplitude_m").get<double>()});
  for (const json& decal : node.at("decals")) plane.decals.push_back(decal_of(decal));
  return plane;
}

json to_json(const Lamp& lamp) {
  return {{"centre", json_of(lamp.centre)},
          {"half_size", json_of(lamp.half_size)},
          {"intensity", lamp.intensity},
          {"all_around", lamp.all_around}};
}

Lamp lamp_of(const json& node) {
  return {vector_of<3>(node.at("centre")), vector_of<2>(node.at("half_size")), node.at("intensity").get<double>(),
          node.at("all_around").get<bool>()};
}

json to_json(const Scene& scene) {
  json node = {{"format", kFormat},           {"seed", scene.seed},       {"low", json_of(scene.low)},
               {"size", json_of(scene.size)}, {"ambient", scene.ambient}, {"walls", json::array()},
               {"bodies", json::array()},     {"lamps", json::array()}};
  for (const Plane& wall : scene.walls) node["walls"].push_back(to_json(wall));
  for (const Body& body : scene.bodies) {
    json faces = json::array();
    for (const Plane& face : body.faces) faces.push_back(to_json(face));
    node["bodies"].push_back({{"name", body.name}, {"faces", faces}});
  }
  for (const Lamp& lamp : scene.lamps) node["lamps"].push_back(to_json(lamp));
  return node;
}

Scene scene_of(const json& node) {
  if (node.at("format") != kFormat) throw ToolError(fmt::format("format is not {}", kFormat));
  Scene scene;
  scene.seed = node.at("seed").get<uint64_t>();
  scene.low = vector_of<3>(node.at("low"));
  scene.size = vector_of<3>(node.at("size"));
  scene.ambient = node.at("ambient").get<double>();
  for (const json& wall : node.at("walls")) scene.walls.push_back(plane_of(wall));
  for (const json& body : node.at("bodies")) {
    Body& read = scene.bodies.emplace_back();
    read.name = body.at("name").get<std::string>();
    for (const json& face : body.at("faces")) read.faces.push_back(plane_of(face));
    bound(read, corners_of(read));
  }
  for (const json& lamp : node.at("lamps")) scene.lamps.push_back(lamp_of(lamp));
  return scene;
}

std::string markers_csv(const Scene& scene) {
  std::string text = "id,x,y,z,nx,ny,nz,radius\n";
  for (const SceneMarker& m : markers_of(scene)) {
    text +=
        fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.6f}\n", m.id, m.centre_room.x(), m.centre_room.y(),
                    m.centre_room.z(), m.normal_room.x(), m.normal_room.y(), m.normal_room.z(), m.radius_m);
  }
  return text;
}

json planes_json(const Scene& scene) {
  json planes = json::array();
  for (const Plane& wall : scene.walls) {
    json polygon = json::array();
    for (const Vec3& corner : polygon_of(scene, wall)) polygon.push_back(json_of(corner));
    const Waviness waviness = waviness_of(wall);
    planes.push_back({{"name", wall.name},
                      {"normal", json_of(wall.normal)},
                      {"d", -wall.normal.dot(wall.origin)},
                      {"wave_sigma_m", waviness.sigma_m},
                      {"wave_max_m", waviness.max_m},
                      {"polygon", polygon}});
  }
  return {{"convention",
           "room frame, metres; plane: normal . X + d = 0, normal points towards free space; wave_* = deviation of "
           "the true surface from this plane"},
          {"planes", planes}};
}

}  // namespace

void write_room(const Scene& scene, const std::filesystem::path& folder) {
  make_folder(folder);
  write_atomic(folder / "markers.csv", markers_csv(scene));
  write_atomic(folder / "planes.json", planes_json(scene).dump(1) + "\n");
  write_atomic(folder / "room.json", to_json(scene).dump(1) + "\n");
}

Scene read_room(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "room.json";
  const std::string text = read_text(path);
  try {
    return scene_of(json::parse(text));
  } catch (const std::exception& error) {
    throw ToolError(path.string() + ": " + error.what() + "; make it again with roomcal simulate room");
  }
}

}  // namespace roomcal::tools
