#include "tools/common/error.h"
#include "tools/common/yaml.h"
#include "tools/map/import_checks.h"
#include "tools/map/map_import.h"

namespace roomcal::tools {

MapData parse_map_yaml(const std::string& name, const std::string& text) {
  const YamlText yaml(name, text);
  const YAML::Node points = yaml.field(yaml.root(), "MapPoints");
  if (!points.IsMap() || points.size() == 0) yaml.fail(points, "`MapPoints` holds no marker; is this the right file?");
  MapData data;
  SeenIds ids;
  for (const auto& entry : points) {
    const auto check = [&](const std::string& wrong) {
      if (!wrong.empty()) yaml.fail(entry.first, wrong);
    };
    map::MapMarker marker;
    check(ids.take(yaml.text(entry.first, "id"), static_cast<std::size_t>(entry.first.Mark().line + 1), marker.id));
    const std::string what = "marker " + std::to_string(marker.id) + ": position";
    marker.p_room = Vec3(yaml.numbers(yaml.field(entry.second, "position"), 3, what).data());
    check(wrong_with_position(marker.p_room));
    data.markers.push_back(marker);
  }
  return data;
}

MapData parse_map_text(const std::string& name, const std::string& text) {
  const bool is_yaml = text.starts_with("MapPoints:") || text.find("\nMapPoints:") != std::string::npos;
  return is_yaml ? parse_map_yaml(name, text) : parse_map_csv(name, text);
}

}  // namespace roomcal::tools
