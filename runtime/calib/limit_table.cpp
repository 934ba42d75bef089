#include "runtime/calib/limit_table.h"

#include <array>
#include <cmath>

namespace roomcal::calib {

namespace {

constexpr std::array<LimitField, 16> kLimits = {{
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
    {"max_intrinsics_sigmas", &Limits::max_intrinsics_sigmas, 1, 100},
    {"moved_p_value", &Limits::moved_p_value, 1e-12, 0.5},
    {"advise_beam_sigmas", &Limits::advise_beam_sigmas, 1, 100},
}};

}  // namespace

std::span<const LimitField> limit_table() { return kLimits; }

double get_limit(const Limits& limits, const LimitField& field) {
  return std::visit([&](auto member) { return static_cast<double>(limits.*member) / field.unit; }, field.field);
}

bool set_limit(Limits& limits, const LimitField& field, double value) {
  if (!(value >= field.least && value <= field.most) || (field.whole() && value != std::floor(value))) return false;
  std::visit(
      [&](auto member) {
        using Member = std::remove_reference_t<decltype(limits.*member)>;
        limits.*member = static_cast<Member>(value * field.unit);
      },
      field.field);
  return true;
}

const LimitField* find_limit(std::string_view name) {
  for (const LimitField& field : kLimits)
    if (field.name == name) return &field;
  return nullptr;
}

}  // namespace roomcal::calib
