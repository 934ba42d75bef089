#include "tools/device/limits_yaml.h"

#include <array>
#include <variant>

#include <fmt/format.h>

namespace roomcal::tools {

namespace {

using calib::Limits;

/// One limit: its key, where it goes, the least and greatest number that make sense, and how many SI units one is.
struct Key {
  const char* name;
  std::variant<double Limits::*, std::size_t Limits::*> field;
  double least, most;
  double unit = 1;
};

constexpr std::array<Key, 15> kKeys = {{
    {"min_inliers", &Limits::min_inliers, 6, 500},
    {"advise_inliers", &Limits::advise_inliers, 0, 500},
    {"advise_coverage", &Limits::advise_coverage, 0, 1},
    {"max_outlier_share", &Limits::max_outlier_share, 0, 0.5},
    {"min_log_likelihood_gap", &Limits::min_log_likelihood_gap, 5, 1000},
    {"min_horizon", &Limits::min_horizon, 0.25, 1},
    {"max_chi2_per_dof", &Limits::max_chi2_per_dof, 1, 1000},
    {"advise_chi2_per_dof", &Limits::advise_chi2_per_dof, 1, 1000},
    {"max_held_out_sigmas", &Limits::max_held_out_sigmas, 1, 100},
    {"advise_held_out_sigmas", &Limits::advise_held_out_sigmas, 1, 100},
    {"max_sigma_t_m", &Limits::max_sigma_t_m, 1e-6, 1},
    {"max_sigma_rot_deg", &Limits::max_sigma_rot_rad, 1e-5, 10, kPi / 180},
    {"max_nominal_sigmas", &Limits::max_nominal_sigmas, 1, 100},
    {"moved_p_value", &Limits::moved_p_value, 1e-12, 0.5},
    {"advise_beam_sigmas", &Limits::advise_beam_sigmas, 1, 100},
}};

/// The worse one is never reached without the better.
struct Order {
  const char *lower, *upper;
};
constexpr std::array<Order, 2> kOrders = {
    {{"advise_chi2_per_dof", "max_chi2_per_dof"}, {"advise_held_out_sigmas", "max_held_out_sigmas"}}};

/// In the file's unit.
double value_of(const Limits& limits, const Key& key) {
  return std::visit([&](auto field) { return static_cast<double>(limits.*field) / key.unit; }, key.field);
}

double value_of(const Limits& limits, std::string_view name) {
  for (const Key& key : kKeys)
    if (key.name == name) return value_of(limits, key);
  return 0;
}

void read_one(const YamlText& yaml, const YAML::Node& node, const Key& key, Limits& limits) {
  const std::string what = std::string("limits: ") + key.name;
  const bool whole = std::holds_alternative<std::size_t Limits::*>(key.field);
  const double value = whole ? yaml.whole_number(node, what) : yaml.number(node, what);
  if (!(value >= key.least && value <= key.most))
    yaml.fail(node, fmt::format("{} must be between {} and {}, got {}", what, key.least, key.most, value));
  std::visit(
      [&](auto field) {
        using Field = std::remove_reference_t<decltype(limits.*field)>;
        limits.*field = static_cast<Field>(value * key.unit);
      },
      key.field);
}

}  // namespace

Limits read_limits(const YamlText& yaml, const YAML::Node& node) {
  std::vector<std::string_view> names;
  for (const Key& key : kKeys) names.emplace_back(key.name);
  yaml.allow_keys(node, names, "limits");
  Limits limits;
  for (const Key& key : kKeys)
    if (const YAML::Node value = node[key.name]; value.IsDefined()) read_one(yaml, value, key, limits);
  for (const Order& order : kOrders)
    if (value_of(limits, order.lower) > value_of(limits, order.upper))
      yaml.fail(node, fmt::format("limits: {} must not be above {}: it would never be said", order.lower, order.upper));
  return limits;
}

std::string limits_text(const Limits& limits) {
  std::string text;
  for (const Key& key : kKeys)
    if (const double value = value_of(limits, key); value != value_of(Limits(), key))
      text += fmt::format("  {}: {}\n", key.name, value);
  return text.empty() ? text : "limits:\n" + text;
}

}  // namespace roomcal::tools
