#include "tools/plan/plan_report.h"

#include <algorithm>

#include <fmt/format.h>

namespace roomcal::tools {

using nlohmann::ordered_json;

namespace {

/// All looks from one place.
struct SamplePlace {
  Vec3 at_room = Vec3::Zero();
  int looks = 0, located = 0;
  double worst_sigma_m = 0, worst_sigma_rad = 0;  ///< of the located looks
};

std::vector<SamplePlace> places_of(const Coverage& coverage) {
  std::vector<SamplePlace> places;
  for (const SampleView& view : coverage.views) {
    if (places.empty() || places.back().at_room != view.T_room_cam.t) places.push_back({view.T_room_cam.t});
    SamplePlace& place = places.back();
    ++place.looks;
    if (!view.located) continue;
    ++place.located;
    place.worst_sigma_m = std::max(place.worst_sigma_m, view.sigma_m);
    place.worst_sigma_rad = std::max(place.worst_sigma_rad, view.sigma_rad);
  }
  return places;
}

std::size_t count_on(const Plan& plan, std::size_t wall) {
  return static_cast<std::size_t>(std::count_if(plan.sheets.begin(), plan.sheets.end(),
                                                [&](const PlannedSheet& sheet) { return sheet.wall == wall; }));
}

ordered_json walls_json(const Plan& plan) {
  ordered_json walls = ordered_json::array();
  for (std::size_t w = 0; w < plan.walls.size(); ++w) {
    ordered_json sheets = ordered_json::array();
    for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
      if (plan.sheets[i].wall != w) continue;
      sheets.push_back(
          {{"id", i}, {"from_left_m", plan.sheets[i].at_m.x()}, {"from_bottom_m", plan.sheets[i].at_m.y()}});
    }
    const Wall& wall = plan.walls[w];
    walls.push_back({{"name", wall.name}, {"size_m", {wall.size_m.x(), wall.size_m.y()}}, {"sheets", sheets}});
  }
  return walls;
}

}  // namespace

std::string layout_csv(const Plan& plan) {
  std::string text = "id,x,y,z,nx,ny,nz,radius\n";
  for (const map::MapMarker& m : plan.data.markers) {
    text += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.9f},{:.9f},{:.9f},{:.6f}\n", m.id, m.p_room.x(), m.p_room.y(),
                        m.p_room.z(), m.normal_room.x(), m.normal_room.y(), m.normal_room.z(), m.radius_m);
  }
  return text;
}

std::string plan_text(const Plan& plan, const PlanOptions& options) {
  std::string text = fmt::format("{} sheets{}\n", plan.sheets.size(), plan.full ? "; no further one fits" : "");
  for (std::size_t w = 0; w < plan.walls.size(); ++w) {
    const Wall& wall = plan.walls[w];
    text += fmt::format("  {:<14} {:5.2f} x {:5.2f} m  {:4} sheets\n", wall.name, wall.size_m.x(), wall.size_m.y(),
                        count_on(plan, w));
  }
  const Coverage& c = plan.coverage;
  text += fmt::format(
      "a camera of {:.0f} degrees finds its place in {:.1f} % of {} looks{}\n  1 sigma, median: {:.2f} mm, {:.3f} deg, "
      "with markers known to {:g} mm\n",
      rad_to_deg(2 * std::atan(0.5 * options.coverage.width_px / options.coverage.focal_px)), 100 * c.located_share,
      c.views.size(), plan.met ? "" : fmt::format(" (short of {:g} %)", 100 * options.target_share),
      1e3 * c.median_sigma_m, rad_to_deg(c.median_sigma_rad), 1e3 * options.map_sigma_m);
  text += "     x     y     z  located  worst sigma\n";
  for (const SamplePlace& place : places_of(c)) {
    text += fmt::format("  {:4.1f}  {:4.1f}  {:4.1f}   {} of {}", place.at_room.x(), place.at_room.y(),
                        place.at_room.z(), place.located, place.looks);
    text += place.located == 0 ? "\n"
                               : fmt::format("   {:6.2f} mm  {:.3f} deg\n", 1e3 * place.worst_sigma_m,
                                             rad_to_deg(place.worst_sigma_rad));
  }
  if (plan.uniqueness) {
    text += fmt::format("the two places most alike differ by {:.0f} mm (sheets {} and {}), the median by {:.0f} mm\n",
                        1e3 * plan.uniqueness->worst_m, plan.uniqueness->worst_id, plan.uniqueness->worst_other_id,
                        1e3 * plan.uniqueness->median_m);
  }
  return text;
}

ordered_json plan_json(const Plan& plan) {
  ordered_json places = ordered_json::array();
  for (const SamplePlace& place : places_of(plan.coverage)) {
    places.push_back({{"at", {place.at_room.x(), place.at_room.y(), place.at_room.z()}},
                      {"looks", place.looks},
                      {"located", place.located},
                      {"sigma_mm", 1e3 * place.worst_sigma_m},
                      {"sigma_deg", rad_to_deg(place.worst_sigma_rad)}});
  }
  return {{"sheets", plan.sheets.size()},
          {"walls", walls_json(plan)},
          {"coverage",
           {{"looks", plan.coverage.views.size()},
            {"located_share", plan.coverage.located_share},
            {"median_sigma_mm", 1e3 * plan.coverage.median_sigma_m},
            {"median_sigma_deg", rad_to_deg(plan.coverage.median_sigma_rad)},
            {"places", places}}},
          {"uniqueness_mm", plan.uniqueness ? ordered_json(1e3 * plan.uniqueness->worst_m) : ordered_json()},
          {"full", plan.full},
          {"met", plan.met}};
}

}  // namespace roomcal::tools
