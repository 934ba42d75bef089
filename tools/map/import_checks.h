#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "runtime/map/room_map.h"

namespace roomcal::tools {

/// What every importer has to refuse. The functions return what is wrong, or an empty text.
std::string wrong_with_position(const Vec3& p_room);
std::string wrong_with_radius(double radius_m);

/// Numbers of markers seen so far, with their lines.
class SeenIds {
 public:
  /// @return what is wrong with `text` as an id, or an empty text and the id.
  std::string take(std::string_view text, std::size_t line, uint32_t& id);

 private:
  std::map<uint32_t, std::size_t> line_of_;
};

}  // namespace roomcal::tools
