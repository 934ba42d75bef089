#include "tools/device/limits_yaml.h"

#include <array>
#include <vector>

#include <fmt/format.h>

#include "runtime/calib/limit_table.h"

namespace roomcal::tools {

namespace {

using calib::LimitField;
using calib::Limits;

/// The worse one is never reached without the better.
struct Order {
  const char *lower, *upper;
};
constexpr std::array<Order, 2> kOrders = {
    {{"advise_chi2_per_dof", "max_chi2_per_dof"}, {"advise_held_out_sigmas", "max_held_out_sigmas"}}};

double value_of(const Limits& limits, const char* name) { return get_limit(limits, *calib::find_limit(name)); }

void read_one(const YamlText& yaml, const YAML::Node& node, const LimitField& field, Limits& limits) {
  const std::string what = fmt::format("limits: {}", field.name);
  const double value = field.whole() ? yaml.whole_number(node, what) : yaml.number(node, what);
  if (!set_limit(limits, field, value))
    yaml.fail(node, fmt::format("{} must be between {} and {}, got {}", what, field.least, field.most, value));
}

}  // namespace

Limits read_limits(const YamlText& yaml, const YAML::Node& node) {
  std::vector<std::string_view> names;
  for (const LimitField& field : calib::limit_table()) names.push_back(field.name);
  yaml.allow_keys(node, names, "limits");
  Limits limits;
  for (const LimitField& field : calib::limit_table())
    if (const YAML::Node value = node[std::string(field.name)]; value.IsDefined()) read_one(yaml, value, field, limits);
  for (const Order& order : kOrders)
    if (value_of(limits, order.lower) > value_of(limits, order.upper))
      yaml.fail(node, fmt::format("limits: {} must not be above {}: it would never be said", order.lower, order.upper));
  return limits;
}

std::string limits_text(const Limits& limits) {
  std::string text;
  for (const LimitField& field : calib::limit_table())
    if (const double value = get_limit(limits, field); value != get_limit(Limits(), field))
      text += fmt::format("  {}: {}\n", field.name, value);
  return text.empty() ? text : "limits:\n" + text;
}

}  // namespace roomcal::tools
