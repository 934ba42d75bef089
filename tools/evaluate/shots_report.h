#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/shots_run.h"

namespace roomcal::tools {

/// A demand and what was measured.
struct ShotsBar {
  std::string demand, measured;
  bool met = false;
};

/// Of shots at the level of observations: clean ones accepted, nothing wrong.
std::vector<ShotsBar> bars_of(const ShotTallies& observed);
/// Of rendered ones: nothing wrong, and both levels agree.
std::vector<ShotsBar> bars_of(const RenderedTallies& both);
bool all_met(const std::vector<ShotsBar>& bars);

/// All figures as Markdown: bars, a row for each kind, refusals by reason.
std::string report_of(const ShotTallies& observed);
/// The same, with a row for each kind and level.
std::string report_of(const RenderedTallies& both);

}  // namespace roomcal::tools
