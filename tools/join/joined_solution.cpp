#include "tools/join/joined_solution.h"

#include <cmath>
#include <string>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

constexpr Eigen::Index kPose = 6, kLens = camera::kIntrinsicsCount;

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }
Eigen::Index lens_at(const TieInput& input, std::size_t unit) { return kPose * at(input.units) + kLens * at(unit); }

}  // namespace

void JoinedSolution::number(const TieInput& input, const TieSolution& tied, std::size_t base, calib::Outcome& outcome) {
  units_.clear();
  lens_units_.clear();
  T_room_sensor_.clear();
  number_of_.assign(input.units, kNone);
  for (std::size_t unit = 0; unit < input.units; ++unit) {
    if (!tied.known[unit]) continue;
    const std::size_t cameras = outcome.cameras.size();
    (unit < cameras ? outcome.cameras[unit].view : outcome.lidars[unit - cameras].sensor) = units_.size();
    number_of_[unit] = units_.size();
    units_.push_back(unit);
    T_room_sensor_.push_back(tied.T_room_rig[base] * tied.T_rig_unit[unit]);
    if (!tied.lens[unit].isZero(0)) lens_units_.push_back(unit);
  }
}

// T_room_rig exp(x) T_rig_unit exp(y) = T_room_unit exp(Ad(T_unit_rig) x + y).
void JoinedSolution::fill_covariance(const TieInput& input, const TieSolution& tied, std::size_t base) {
  const Eigen::Index poses = kPose * at(units_.size()), size = poses + kLens * at(lens_units_.size());
  const Eigen::Index shot = (kPose + kLens) * at(input.units) + kPose * at(base);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(size, tied.cov.rows());
  for (std::size_t k = 0; k < units_.size(); ++k) {
    by.block<kPose, kPose>(kPose * at(k), shot) = se3_adjoint(tied.T_rig_unit[units_[k]].inverse());
    by.block<kPose, kPose>(kPose * at(k), kPose * at(units_[k])).setIdentity();
  }
  for (std::size_t k = 0; k < lens_units_.size(); ++k)
    by.block<kLens, kLens>(poses + kLens * at(k), lens_at(input, lens_units_[k])).setIdentity();
  const Eigen::MatrixXd cov = by * tied.cov * by.transpose();
  cov_room_.assign(cov.data(), cov.data() + cov.size());  // symmetric: rows or columns first is the same
}

void JoinedSolution::fill_fits(const TieInput& input, const rig::RigSolution& alone, const std::vector<ViewFit>& fits) {
  const std::size_t n = units_.size();
  rms_px_.assign(n, 0);
  chi2_camera_.assign(n, 0);
  outliers_.assign(n, 0);
  std::vector<double> rings(n, 0);
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const std::size_t number = number_of_[input.sightings[k].unit];
    if (number == kNone || fits[k].rings == 0) continue;
    const auto count = static_cast<double>(fits[k].rings);
    rms_px_[number] += count * alone.rms_px[k] * alone.rms_px[k];
    rings[number] += count;
    outliers_[number] = static_cast<uint16_t>(outliers_[number] + alone.outliers[k]);
    if (fits[k].told) chi2_camera_[number] = alone.chi2_camera[k];
  }
  for (std::size_t i = 0; i < n; ++i) rms_px_[i] = rings[i] > 0 ? std::sqrt(rms_px_[i] / rings[i]) : 0;
}

void JoinedSolution::fill_lenses(const calib::Device& device, const TieInput& input, const TieSolution& tied,
                                 calib::Outcome& outcome) {
  lenses_.clear();
  for (const std::size_t unit : lens_units_) {
    const camera::Intrinsics& given = device.cameras[unit].camera.intrinsics();
    const Result<camera::Camera> refined = camera::Camera::create(camera::with_parameters(given, tied.lens[unit]));
    require(refined.status(), std::string(device.cameras[unit].name.view()) + ": refined over all shots");
    rig::RefinedLens lens;
    lens.view = outcome.cameras[unit].view;
    lens.camera = outcome.cameras[unit].camera = refined.value();
    lens.prior = camera::parameters_of(given);
    lens.prior_sigma = device.intrinsics_sigma(unit);
    lens.sigma = tied.cov.diagonal().segment<kLens>(lens_at(input, unit)).cwiseMax(0).cwiseSqrt();
    lenses_.push_back(lens);
  }
}

void JoinedSolution::fill(const calib::Device& device, const TieInput& input, const TieSolution& tied, std::size_t base,
                          const rig::RigSolution& alone, const std::vector<ViewFit>& fits, calib::Outcome& outcome) {
  number(input, tied, base, outcome);
  fill_covariance(input, tied, base);
  fill_fits(input, alone, fits);
  fill_lenses(device, input, tied, outcome);
  rig::RigSolution& solution = outcome.solution;
  solution = alone;
  solution.T_room_sensor = T_room_sensor_;
  solution.cov_room = cov_room_;
  solution.lenses = lenses_;
  solution.rms_px = rms_px_;
  solution.outliers = outliers_;
  solution.chi2_camera = chi2_camera_;
  solution.chi2 += tied.chi2;
  solution.degrees_of_freedom += tied.degrees_of_freedom;
}

}  // namespace roomcal::tools
