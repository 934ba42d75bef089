#include "tools/common/option_check.h"

#include <fmt/format.h>

#include "tools/common/yaml.h"

namespace roomcal::tools {

CLI::Validator number_between(double low, double high, const std::string& unit) {
  const std::string range = fmt::format("{} to {}{}{}", low, high, unit.empty() ? "" : " ", unit);
  const auto refuse = [=](const std::string& text) -> std::string {
    double value = 0;
    const bool fits = parse_finite(text, value) && value >= low && value <= high;
    return fits ? "" : fmt::format("{} is not a number from {}", text, range);
  };
  return CLI::Validator(refuse, "in [" + range + "]");
}

}  // namespace roomcal::tools
