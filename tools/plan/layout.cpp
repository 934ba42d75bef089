#include "tools/plan/layout.h"

#include <algorithm>
#include <cmath>

namespace roomcal::tools {

namespace {

constexpr int kCandidates = 12;   // more would be more even and more alike
constexpr int kTries = 4000;      // a place that one try in a thousand hits is found with 98 %
constexpr double kStep_m = 0.01;  // what a person with a tape measure can set

Vec2 to_step(const Vec2& at_m) { return (at_m / kStep_m).array().round().matrix() * kStep_m; }

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

}  // namespace

Vec3 place_room(const std::vector<Wall>& walls, const PlannedSheet& sheet) {
  return walls[sheet.wall].point_room(sheet.at_m);
}

LayoutMaker::LayoutMaker(const std::vector<Wall>& walls, const SheetOutline& outline, uint64_t seed)
    : walls_(walls), outline_(outline), random_(seed) {
  for (const Wall& wall : walls) area_m2_ += wall.size_m.prod();
}

Eigen::AlignedBox2d LayoutMaker::box_of(const Vec2& at_m, double border_m) const {
  return {at_m + outline_.below_left_m - Vec2::Constant(border_m),
          at_m + outline_.above_right_m + Vec2::Constant(border_m)};
}

bool LayoutMaker::fits(const PlannedSheet& sheet, std::size_t except) const {
  const Wall& wall = walls_[sheet.wall];
  const Eigen::AlignedBox2d with_margin = box_of(sheet.at_m, outline_.margin_m);
  constexpr double kRounding_m = 1e-9;
  if (with_margin.min().minCoeff() < -kRounding_m) return false;
  if ((wall.size_m - with_margin.max()).minCoeff() < -kRounding_m) return false;
  for (const Eigen::AlignedBox2d& keep_out : wall.keep_out_m) {
    if (with_margin.intersects(keep_out)) return false;
  }
  const Eigen::AlignedBox2d with_gap = box_of(sheet.at_m, outline_.gap_m);
  for (std::size_t i = 0; i < sheets_.size(); ++i) {
    if (i == except || sheets_[i].wall != sheet.wall) continue;
    if (with_gap.intersects(box_of(sheets_[i].at_m, 0))) return false;
  }
  return true;
}

PlannedSheet LayoutMaker::draw() {
  PlannedSheet sheet;
  double pick_m2 = random_.uniform(0, area_m2_);
  for (; sheet.wall + 1 < walls_.size(); ++sheet.wall) {
    pick_m2 -= walls_[sheet.wall].size_m.prod();
    if (pick_m2 < 0) break;
  }
  const Vec2& size_m = walls_[sheet.wall].size_m;
  const double x_m = random_.uniform(0, size_m.x());
  sheet.at_m = to_step({x_m, random_.uniform(0, size_m.y())});
  return sheet;
}

double LayoutMaker::distance_to_nearest_m(const PlannedSheet& sheet) const {
  const Vec3 p_room = place_room(walls_, sheet);
  double nearest_m = INFINITY;
  for (const PlannedSheet& other : sheets_) {
    nearest_m = std::min(nearest_m, (place_room(walls_, other) - p_room).norm());
  }
  return nearest_m;
}

bool LayoutMaker::add() {
  PlannedSheet best;
  double best_m = -1;
  for (int attempt = 0, valid = 0; attempt < kTries && valid < kCandidates; ++attempt) {
    const PlannedSheet candidate = draw();
    if (!fits(candidate, kNone)) continue;
    ++valid;
    const double distance_m = distance_to_nearest_m(candidate);
    if (distance_m <= best_m) continue;
    best_m = distance_m;
    best = candidate;
  }
  if (best_m < 0) return false;
  sheets_.push_back(best);
  return true;
}

bool LayoutMaker::move(std::size_t sheet, double reach_m) {
  constexpr double kLeast = 0.4;  // of the reach: less is no other place
  for (int attempt = 0; attempt < kTries; ++attempt) {
    PlannedSheet moved = sheets_[sheet];
    const double angle_rad = random_.uniform(-kPi, kPi), away_m = random_.uniform(kLeast * reach_m, reach_m);
    moved.at_m = to_step(moved.at_m + away_m * Vec2(std::cos(angle_rad), std::sin(angle_rad)));
    if (!fits(moved, sheet)) continue;
    sheets_[sheet] = moved;
    return true;
  }
  return false;
}

MapData map_of(const std::vector<Wall>& walls, const std::vector<PlannedSheet>& sheets, std::size_t count,
               double radius_m, double sigma_m) {
  MapData data;
  data.id = "plan";
  data.provenance = "planned, not measured";
  for (std::size_t i = 0; i < count; ++i) {
    map::MapMarker marker;
    marker.id = static_cast<uint32_t>(i);
    marker.p_room = place_room(walls, sheets[i]);
    marker.normal_room = walls[sheets[i].wall].normal_room();
    marker.radius_m = radius_m;
    marker.cov_m2 = sigma_m * sigma_m * Mat33::Identity();
    marker.has_normal = marker.has_radius = true;
    data.markers.push_back(marker);
  }
  return data;
}

}  // namespace roomcal::tools
