#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/plan/plan.h"

namespace roomcal::tools {

/// The layout as `roomcal map import` reads it: id,x,y,z,nx,ny,nz,radius.
std::string layout_csv(const Plan& plan);

/// How many sheets on which wall, and for every sample place how well a camera there will know where it is.
std::string plan_text(const Plan& plan, const PlanOptions& options);

/// {sheets, walls [{name, size_m, sheets [{id, from_left_m, from_bottom_m}]}], coverage {looks, located_share,
/// median_sigma_mm, median_sigma_deg, places [{at, looks, located, sigma_mm, sigma_deg}]}, uniqueness_mm, full, met}.
nlohmann::ordered_json plan_json(const Plan& plan);

}  // namespace roomcal::tools
