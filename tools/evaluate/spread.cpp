#include "tools/evaluate/spread.h"

#include <algorithm>
#include <cmath>

namespace roomcal::tools {

Spread spread_of(const std::vector<double>& values, double unit) {
  if (values.empty()) return {};
  const auto count = static_cast<double>(values.size());
  Spread spread;
  for (const double value : values) {
    spread.mean += value / count;
    spread.rms += value * value / count;
    spread.worst = std::max(spread.worst, std::abs(value));
  }
  for (const double value : values) spread.sd += (value - spread.mean) * (value - spread.mean);
  spread.sd = values.size() > 1 ? std::sqrt(spread.sd / (count - 1)) : 0;
  return {unit * spread.mean, unit * spread.sd, unit * std::sqrt(spread.rms), unit * spread.worst};
}

}  // namespace roomcal::tools
