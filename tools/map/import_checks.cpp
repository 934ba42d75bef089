#include "tools/map/import_checks.h"

#include <charconv>

#include <fmt/format.h>

#include "runtime/map/format.h"

namespace roomcal::tools {

std::string wrong_with_position(const Vec3& p_room) {
  if (p_room.cwiseAbs().maxCoeff() <= map::kMaxCoordinate_m) return "";
  return fmt::format("position: beyond {:.0f} m; coordinates are metres in the room frame", map::kMaxCoordinate_m);
}

std::string wrong_with_radius(double radius_m) {
  if (radius_m > 0 && radius_m <= map::kMaxRadius_m) return "";
  return fmt::format("radius: {} is not between 0 and {:.0f} m; it is the outer circle's radius in metres", radius_m,
                     map::kMaxRadius_m);
}

std::string SeenIds::take(std::string_view text, std::size_t line, uint32_t& id) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) {
    return fmt::format("id: `{}` is not a whole number from 0 to 4294967295", text);
  }
  const auto [entry, is_new] = line_of_.emplace(id, line);
  if (!is_new) return fmt::format("id: {} stands already on line {}; every marker needs its own", id, entry->second);
  if (line_of_.size() > map::kMaxMarkers) return fmt::format("more than {} markers; split the room", map::kMaxMarkers);
  return "";
}

}  // namespace roomcal::tools
