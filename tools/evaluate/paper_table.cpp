#include "tools/evaluate/paper_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace roomcal::tools {

std::string figure(double value) {
  if (value == 0) return "0";
  const int before = static_cast<int>(std::floor(std::log10(std::abs(value))));
  return fmt::format("{:.{}f}", value, std::clamp(2 - before, 0, 6));
}

std::string times_smaller(double paper, double ours) {
  return paper > 0 && ours > 0 ? fmt::format("{:.{}f} x", paper / ours, paper / ours < 10 ? 1 : 0) : "-";
}

}  // namespace roomcal::tools
