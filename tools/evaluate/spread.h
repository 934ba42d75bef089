#pragma once

#include <vector>

namespace roomcal::tools {

/// Mean, standard deviation, root mean square and largest magnitude of some numbers; all 0 for none.
struct Spread {
  double mean = 0, sd = 0, rms = 0, worst = 0;
};
/// @param unit  each value is multiplied by it first.
Spread spread_of(const std::vector<double>& values, double unit = 1);

}  // namespace roomcal::tools
