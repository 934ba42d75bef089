#include "tools/plan/plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/map/format.h"
#include "tools/common/error.h"
#include "tools/map/complete_map.h"

namespace roomcal::tools {

namespace {

constexpr std::size_t kFewest = 18;     // fewer cannot be told apart (tools/map/uniqueness.h)
constexpr double kFirstPerArea_m2 = 2;  // the search begins there; the paper's room has 7
constexpr double kGrowth = 1.125;
constexpr int kUniquenessRounds = 8;
constexpr double kMoveReach_m = 0.12;

double area_m2(const std::vector<Wall>& walls) {
  double sum = 0;
  for (const Wall& wall : walls) sum += wall.size_m.prod();
  return sum;
}

MapData whole_map(const std::vector<Wall>& walls, const LayoutMaker& maker, const PlanOptions& options) {
  MapData data = map_of(walls, maker.sheets(), maker.sheets().size(), options.outline.radius_m, options.map_sigma_m);
  complete_map(data);
  return data;
}

/// @return false if they do not all fit.
bool grow_to(std::size_t count, LayoutMaker& maker) {
  while (maker.sheets().size() < count) {
    if (!maker.add()) return false;
  }
  return true;
}

void refuse_if_too_small(std::size_t fitted, const PlanOptions& options) {
  if (fitted == 0) {
    throw ToolError(
        "no sheet fits on the walls: they are smaller than a sheet with its margin, or all kept out; "
        "take smaller paper or larger walls");
  }
  if (options.sheets > fitted) {
    throw ToolError(fmt::format("--sheets {}: only {} fit on the walls; take fewer, smaller paper or larger walls",
                                options.sheets, fitted));
  }
  if (fitted < kFewest) {
    throw ToolError(fmt::format("only {} sheets fit on the walls, a room needs {}; take smaller paper or larger walls",
                                fitted, kFewest));
  }
}

// Grows the layout until the coverage is met, it is full, or holds what was asked for.
void find_count(const PlanOptions& options, LayoutMaker& maker, Plan& plan) {
  const double first = std::max<double>(kFewest, kFirstPerArea_m2 * area_m2(plan.walls));
  auto count = options.sheets > 0 ? options.sheets : static_cast<std::size_t>(std::lround(first));
  while (true) {
    count = std::min(count, map::kMaxMarkers);
    plan.full = !grow_to(count, maker);
    refuse_if_too_small(maker.sheets().size(), options);
    plan.data = whole_map(plan.walls, maker, options);
    plan.coverage = measure_coverage(plan.data, options.coverage);
    plan.met = plan.coverage.located_share >= options.target_share;
    if (plan.met || plan.full || options.sheets > 0 || count == map::kMaxMarkers) return;
    count = std::max(count + 1, static_cast<std::size_t>(std::lround(kGrowth * static_cast<double>(count))));
  }
}

// @return whether a sheet was moved.
bool pull_apart(const PlanOptions& options, LayoutMaker& maker, Plan& plan) {
  bool moved = false;
  plan.uniqueness = measure_uniqueness(plan.data.markers);
  for (int round = 0; round < kUniquenessRounds; ++round) {
    if (!plan.uniqueness || plan.uniqueness->worst_m >= options.least_unique_m) break;
    if (!maker.move(plan.uniqueness->worst_id, kMoveReach_m)) break;
    moved = true;
    plan.data =
        map_of(plan.walls, maker.sheets(), maker.sheets().size(), options.outline.radius_m, options.map_sigma_m);
    plan.uniqueness = measure_uniqueness(plan.data.markers);
  }
  return moved;
}

}  // namespace

Plan make_plan(const std::vector<Wall>& walls, const PlanOptions& options) {
  Plan plan;
  plan.walls = walls;
  LayoutMaker maker(plan.walls, options.outline, options.seed);
  find_count(options, maker, plan);
  if (pull_apart(options, maker, plan)) {
    plan.data = whole_map(plan.walls, maker, options);
    plan.coverage = measure_coverage(plan.data, options.coverage);
    plan.met = plan.coverage.located_share >= options.target_share;
  }
  plan.sheets = maker.sheets();
  return plan;
}

}  // namespace roomcal::tools
