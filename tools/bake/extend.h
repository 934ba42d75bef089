#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/bake/bake.h"

namespace roomcal::tools {

struct ExtendOptions {
  double same_m = 0.005;   ///< a marker found again within this, or four sigmas, is where it was
  double moved_m = 0.3;    ///< one that is gone and a new one within this are one that was moved; farther: gone and new
  double overlap_m = 0.1;  ///< sheets cannot overlap: a new one this near to an old one's place says that that is gone
  std::size_t looks = 4;   ///< views that should have shown a marker which none of them did: it is gone
  double max_slant_rad = deg_to_rad(60.0);  ///< of such a view
};

struct MovedMarker {
  uint32_t id = 0;  ///< kept
  Vec3 from_room = Vec3::Zero(), to_room = Vec3::Zero();
};

/// What a new survey says about an old map, in the old map's frame and ids.
struct MapChanges {
  std::size_t same = 0;   ///< found where they were; measured anew, old and new place weighed by their covariance
  double same_rms_m = 0;  ///< between old and new place
  double scale = 1;       ///< the survey was multiplied by this: the old map holds the scale
  std::vector<MovedMarker> moved;
  std::vector<uint32_t> vanished;  ///< looked for and not there
  std::vector<uint32_t> added;     ///< new ids, after the old map's last
  std::vector<uint32_t> unseen;    ///< the survey did not look there: kept as they were
};

/// Puts a new survey of a changed room into the old map. The old map holds frame, scale and ids; it is aligned to what
/// did not change, found without identities.
/// @param[out] changes  all that differs.
/// @return the new map, whole, with the old one's id; provenance and time are the caller's.
/// @throws ToolError if the survey and the map have no place in common.
MapData extend_map(const MapData& old, const BakeResult& fresh, const ExtendOptions& options, MapChanges& changes);

/// {same, same_rms_mm, scale, moved [{id, distance_mm, from, to}], vanished, added, unseen}.
nlohmann::ordered_json changes_json(const MapChanges& changes);

/// The same for people.
std::string changes_text(const MapChanges& changes);

}  // namespace roomcal::tools
