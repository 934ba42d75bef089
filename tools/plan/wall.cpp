#include "tools/plan/wall.h"

#include <cstdio>

#include <fmt/format.h>

#include "tools/common/error.h"
#include "tools/common/yaml.h"

namespace roomcal::tools {

namespace {

constexpr double kSmallest_m = 1, kLargest_m = 50;

Vec3 vector_of(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

class WallReader {
 public:
  explicit WallReader(const YamlText& yaml) : yaml_(yaml) {}

  std::vector<Wall> read() const {
    yaml_.allow_keys(yaml_.root(), {"walls"}, "the file");
    const YAML::Node list = yaml_.field(yaml_.root(), "walls");
    if (!list.IsSequence() || list.size() == 0) yaml_.fail(list, "walls: expected a list with a wall or more");
    std::vector<Wall> walls;
    for (const YAML::Node& node : list) walls.push_back(read_wall(node));
    return walls;
  }

 private:
  Wall read_wall(const YAML::Node& node) const {
    yaml_.allow_keys(node, {"name", "corner", "right", "up", "size", "keep_out"}, "a wall");
    Wall wall;
    wall.name = yaml_.text(yaml_.field(node, "name"), "name");
    wall.corner_room = vector_of(yaml_.numbers(yaml_.field(node, "corner"), 3, wall.name + ": corner"));
    if (wall.corner_room.cwiseAbs().maxCoeff() > 1000) yaml_.fail(node, wall.name + ": corner: beyond 1000 m");
    wall.right_room = direction(yaml_.field(node, "right"), wall.name + ": right");
    wall.up_room = node["up"] ? direction(node["up"], wall.name + ": up") : Vec3(Vec3::UnitZ());
    if (std::abs(wall.right_room.dot(wall.up_room)) > 0.01) {
      yaml_.fail(node, wall.name + ": right and up are not at a right angle; a floor or ceiling needs its own `up`");
    }
    wall.up_room = (wall.up_room - wall.up_room.dot(wall.right_room) * wall.right_room).normalized();
    const auto size = yaml_.numbers(yaml_.field(node, "size"), 2, wall.name + ": size");
    wall.size_m = {size[0], size[1]};
    if (!(wall.size_m.minCoeff() > 0 && wall.size_m.maxCoeff() <= kLargest_m)) {
      yaml_.fail(node,
                 fmt::format("{}: size: width and height must be above 0 and at most {} m", wall.name, kLargest_m));
    }
    if (node["keep_out"]) read_keep_out(node["keep_out"], wall);
    return wall;
  }

  Vec3 direction(const YAML::Node& node, const std::string& what) const {
    const Vec3 v = vector_of(yaml_.numbers(node, 3, what));
    if (!(v.norm() > 1e-6 && v.norm() < 1e6)) yaml_.fail(node, what + ": has no direction");
    return v.normalized();
  }

  void read_keep_out(const YAML::Node& list, Wall& wall) const {
    if (!list.IsSequence()) yaml_.fail(list, wall.name + ": keep_out: expected a list of [left, bottom, right, top]");
    for (const YAML::Node& node : list) {
      const auto box = yaml_.numbers(node, 4, wall.name + ": keep_out");
      if (!(box[0] < box[2] && box[1] < box[3])) {
        yaml_.fail(node, wall.name + ": keep_out: expected left < right and bottom < top");
      }
      wall.keep_out_m.emplace_back(Vec2(box[0], box[1]), Vec2(box[2], box[3]));
    }
  }

  const YamlText& yaml_;
};

}  // namespace

std::vector<Wall> box_walls(const std::string& text, bool with_ceiling) {
  Vec3 size;
  char rest = 0;
  const bool read = std::sscanf(text.c_str(), "%lfx%lfx%lf%c", &size.x(), &size.y(), &size.z(), &rest) == 3;
  if (!read || !(size.minCoeff() >= kSmallest_m && size.maxCoeff() <= kLargest_m)) {
    throw ToolError(fmt::format("--room {}: want width x depth x height, each {} to {} m, as in 3x4x2.7", text,
                                kSmallest_m, kLargest_m));
  }
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const double w = size.x(), d = size.y(), h = size.z();
  std::vector<Wall> walls{{"floor", Vec3::Zero(), x, y, {w, d}, {}},
                          {"wall y = 0", {w, 0, 0}, -x, z, {w, h}, {}},
                          {fmt::format("wall x = {:g}", w), {w, d, 0}, -y, z, {d, h}, {}},
                          {fmt::format("wall y = {:g}", d), {0, d, 0}, x, z, {w, h}, {}},
                          {"wall x = 0", Vec3::Zero(), y, z, {d, h}, {}}};
  if (with_ceiling) walls.push_back({"ceiling", {w, 0, h}, -x, y, {w, d}, {}});
  return walls;
}

std::vector<Wall> read_walls(const std::string& name, const std::string& text) {
  const YamlText yaml(name, text);
  return WallReader(yaml).read();
}

}  // namespace roomcal::tools
