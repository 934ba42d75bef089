#pragma once

#include <cstdint>
#include <vector>

#include "tools/common/random.h"
#include "tools/map/map_data.h"
#include "tools/plan/wall.h"

namespace roomcal::tools {

/// The paper around a marker: what must not overlap.
struct SheetOutline {
  double radius_m = 0.085;
  Vec2 below_left_m = Vec2::Zero();   ///< from the marker's centre to the sheet's lower left corner; negative
  Vec2 above_right_m = Vec2::Zero();  ///< to its upper right corner
  double gap_m = 0.02;                ///< between sheets
  double margin_m = 0.05;             ///< to the end of the wall and to what must stay free
};

/// A sheet on a wall; upright, its number the place in the list.
struct PlannedSheet {
  std::size_t wall = 0;
  Vec2 at_m = Vec2::Zero();  ///< marker's centre in the wall's coordinates, to the centimetre
};

/// Puts sheets on walls one by one, each of them where it is far from those before it: a layout's first sheets are an
/// even layout of their own.
///
/// Mitchell's best candidate (SIGGRAPH 1991): even, and as irregular as chance, which is what makes places differ.
class LayoutMaker {
 public:
  LayoutMaker(const std::vector<Wall>& walls, const SheetOutline& outline, uint64_t seed);

  /// @return false if no place was found; the layout is full.
  bool add();
  /// Puts one sheet elsewhere, within `reach_m` of where it is. @return false, nothing changed, if there is no place.
  bool move(std::size_t sheet, double reach_m);
  const std::vector<PlannedSheet>& sheets() const { return sheets_; }

 private:
  Eigen::AlignedBox2d box_of(const Vec2& at_m, double border_m) const;
  bool fits(const PlannedSheet& sheet, std::size_t except) const;
  PlannedSheet draw();
  double distance_to_nearest_m(const PlannedSheet& sheet) const;

  const std::vector<Wall>& walls_;
  SheetOutline outline_;
  Random random_;
  double area_m2_ = 0;
  std::vector<PlannedSheet> sheets_;
};

/// Centre of a sheet's marker.
Vec3 place_room(const std::vector<Wall>& walls, const PlannedSheet& sheet);

/// The first `count` sheets as a map would have them: ids from 0, exact up to `sigma_m` per axis; not yet complete.
MapData map_of(const std::vector<Wall>& walls, const std::vector<PlannedSheet>& sheets, std::size_t count,
               double radius_m, double sigma_m);

}  // namespace roomcal::tools
