#include "tools/join/tie.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr Eigen::Index kPose = 6, kLens = camera::kIntrinsicsCount;
constexpr int kMaxRounds = 20;

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// Lays unknowns and residuals out, and iterates.
class Tie {
 public:
  explicit Tie(const TieInput& input) : input_(input) {
    solution_.known.assign(input.units, false);
    solution_.placed.assign(input.shots, false);
    solution_.T_rig_unit.resize(input.units);
    solution_.lens.assign(input.units, camera::Parameters::Zero());
    solution_.T_room_rig.resize(input.shots);
    start();
    choose_unknowns();
    choose_rows();
    weigh();
  }

  TieSolution solve() {
    for (int round = 0; round < kMaxRounds; ++round) {
      linearize();
      const VectorXd step = -(J_.transpose() * weight_ * J_ + mounts_).ldlt().solve(J_.transpose() * weight_ * e_ + g_);
      move(step);
      if (step.norm() < 1e-12 * std::sqrt(static_cast<double>(step.size() + 1))) break;
    }
    linearize();
    const MatrixXd free = J_.transpose() * weight_ * J_;
    solution_.cov_free = spread(free);
    solution_.cov = spread(free + mounts_);
    solution_.chi2 = e_.dot(weight_ * e_);
    solution_.degrees_of_freedom = static_cast<int>(J_.rows() - J_.cols());
    return std::move(solution_);
  }

 private:
  bool is_in(const Sighting& s) const { return s.unit != input_.without; }
  /// The reference, or where no shot sees it, any other.
  std::size_t gauge() const {
    const auto is_reference = [&](const Sighting& s) { return s.unit == input_.reference && is_in(s); };
    if (std::any_of(input_.sightings.begin(), input_.sightings.end(), is_reference)) return input_.reference;
    const auto any =
        std::find_if(input_.sightings.begin(), input_.sightings.end(), [&](const Sighting& s) { return is_in(s); });
    return any == input_.sightings.end() ? input_.reference : any->unit;
  }

  // From the gauge through the shots that see it to the units that they see, and on.
  void start() {
    solution_.known[gauge()] = true;
    for (bool grown = true; grown;) {
      grown = false;
      for (const Sighting& s : input_.sightings) {
        if (!is_in(s) || solution_.known[s.unit] == solution_.placed[s.shot]) continue;
        grown = true;
        if (solution_.known[s.unit])
          solution_.T_room_rig[s.shot] = s.T_room_sensor * solution_.T_rig_unit[s.unit].inverse();
        else
          solution_.T_rig_unit[s.unit] = solution_.T_room_rig[s.shot].inverse() * s.T_room_sensor;
        solution_.known[s.unit] = solution_.placed[s.shot] = true;
      }
    }
    for (const Sighting& s : input_.sightings)
      if (uses(s) && s.lens != kNone) solution_.lens[s.unit] = input_.lens[s.lens];
  }

  bool uses(const Sighting& s) const { return is_in(s) && solution_.known[s.unit]; }

  /// Columns of the full layout that are free: units but the gauge, parameters of lenses that may move, shots.
  void choose_unknowns() {
    const std::size_t units = input_.units;
    full_size_ = at(units) * (kPose + kLens) + at(input_.shots) * kPose;
    std::vector<bool> free(static_cast<std::size_t>(full_size_), false);
    const auto open = [&](Eigen::Index first, Eigen::Index i) { free[static_cast<std::size_t>(first + i)] = true; };
    for (std::size_t u = 0; u < units; ++u)
      for (Eigen::Index i = 0; i < kPose && solution_.known[u] && u != gauge(); ++i) open(unit_at(u), i);
    for (const Sighting& s : input_.sightings)
      for (Eigen::Index i = 0; i < kLens && uses(s) && s.lens != kNone; ++i)
        if (input_.cov(lens_row(s) + i, lens_row(s) + i) > 0) open(lens_at(s.unit), i);
    for (std::size_t s = 0; s < input_.shots; ++s)
      for (Eigen::Index i = 0; i < kPose && solution_.placed[s]; ++i) open(shot_at(s), i);
    for (std::size_t i = 0; i < free.size(); ++i)
      if (free[i]) unknowns_.push_back(at(i));
  }

  void choose_rows() {
    for (std::size_t k = 0; k < input_.sightings.size(); ++k)
      for (Eigen::Index i = 0; i < kPose && uses(input_.sightings[k]); ++i) rows_.push_back(at(k) * kPose + i);
    for (const Sighting& s : input_.sightings)
      for (Eigen::Index i = 0; i < kLens && uses(s) && s.lens != kNone; ++i)
        if (input_.cov(lens_row(s) + i, lens_row(s) + i) > 0) rows_.push_back(lens_row(s) + i);
  }

  // Metres, radians and pixels in one matrix: scaled to unit diagonal before it is inverted.
  void weigh() {
    const MatrixXd cov = input_.cov(rows_, rows_);
    const bool positive = (cov.diagonal().array() > 0).all();  // NaN: no
    const VectorXd unit = cov.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::LLT<MatrixXd> solver(unit.asDiagonal() * cov * unit.asDiagonal());
    if (!positive || solver.info() != Eigen::Success)
      throw ToolError(
          "the shots' joint covariance is not positive definite: leave out shots from one and the same place");
    weight_ = unit.asDiagonal() * solver.solve(MatrixXd::Identity(cov.rows(), cov.cols())) * unit.asDiagonal();
  }

  void linearize() {
    MatrixXd J = MatrixXd::Zero(input_.cov.rows(), full_size_);
    VectorXd e = VectorXd::Zero(input_.cov.rows());
    for (std::size_t k = 0; k < input_.sightings.size(); ++k) {
      const Sighting& s = input_.sightings[k];
      if (!uses(s)) continue;
      const SE3& T_rig_unit = solution_.T_rig_unit[s.unit];
      const Vec6 xi = se3_log(s.T_room_sensor.inverse() * solution_.T_room_rig[s.shot] * T_rig_unit);
      const Mat66 by_unit = se3_right_jacobian_inverse(xi);
      e.segment<kPose>(at(k) * kPose) = xi;
      J.block<kPose, kPose>(at(k) * kPose, unit_at(s.unit)) = by_unit;
      J.block<kPose, kPose>(at(k) * kPose, shot_at(s.shot)) = by_unit * se3_adjoint(T_rig_unit.inverse());
      if (s.lens == kNone) continue;
      e.segment<kLens>(lens_row(s)) = solution_.lens[s.unit] - input_.lens[s.lens];
      J.block<kLens, kLens>(lens_row(s), lens_at(s.unit)).setIdentity();
    }
    J_ = J(rows_, unknowns_);
    e_ = e(rows_);
    linearize_mounts();
  }

  void linearize_mounts() {
    MatrixXd H = MatrixXd::Zero(full_size_, full_size_);
    VectorXd g = VectorXd::Zero(full_size_);
    for (const TieMount& mount : input_.mounts) {
      if (!solution_.known[mount.unit] || gauge() != input_.reference) continue;
      Vec6 weight;
      weight << Vec3::Constant(1 / (mount.sigma_t_m * mount.sigma_t_m)),
          Vec3::Constant(1 / (mount.sigma_rot_rad * mount.sigma_rot_rad));
      const Vec6 xi = se3_log(mount.T_rig_unit.inverse() * solution_.T_rig_unit[mount.unit]);
      const Mat66 by_unit = se3_right_jacobian_inverse(xi);
      const Mat66 weighted = by_unit.transpose() * weight.asDiagonal();
      H.block<kPose, kPose>(unit_at(mount.unit), unit_at(mount.unit)) += weighted * by_unit;
      g.segment<kPose>(unit_at(mount.unit)) += weighted * xi;
    }
    mounts_ = H(unknowns_, unknowns_);
    g_ = g(unknowns_);
  }

  void move(const VectorXd& step) {
    VectorXd full = VectorXd::Zero(full_size_);
    full(unknowns_) = step;
    for (std::size_t u = 0; u < input_.units; ++u) {
      solution_.T_rig_unit[u] = solution_.T_rig_unit[u] * se3_exp(full.segment<kPose>(unit_at(u)));
      solution_.lens[u] += full.segment<kLens>(lens_at(u));
    }
    for (std::size_t s = 0; s < input_.shots; ++s)
      solution_.T_room_rig[s] = solution_.T_room_rig[s] * se3_exp(full.segment<kPose>(shot_at(s)));
  }

  /// The inverse of an information of the unknowns, over the full layout.
  MatrixXd spread(const MatrixXd& information) const {
    const VectorXd unit = information.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = unit.asDiagonal() * information * unit.asDiagonal();
    MatrixXd full = MatrixXd::Zero(full_size_, full_size_);
    full(unknowns_, unknowns_) =
        unit.asDiagonal() * scaled.ldlt().solve(MatrixXd::Identity(scaled.rows(), scaled.cols())) * unit.asDiagonal();
    return full;
  }

  Eigen::Index unit_at(std::size_t unit) const { return at(unit) * kPose; }
  Eigen::Index lens_at(std::size_t unit) const { return at(input_.units) * kPose + at(unit) * kLens; }
  Eigen::Index shot_at(std::size_t shot) const { return at(input_.units) * (kPose + kLens) + at(shot) * kPose; }
  Eigen::Index lens_row(const Sighting& s) const { return at(input_.sightings.size()) * kPose + at(s.lens) * kLens; }

  const TieInput& input_;
  TieSolution solution_;
  Eigen::Index full_size_ = 0;
  std::vector<Eigen::Index> unknowns_, rows_;
  MatrixXd weight_, J_, mounts_;
  VectorXd e_, g_;
};

}  // namespace

TieSolution tie(const TieInput& input) { return Tie(input).solve(); }

double chi_square_tail(double x, int n) {
  if (n <= 0) return 1;
  const double k = 2.0 / (9.0 * n);
  return 0.5 * std::erfc((std::cbrt(x / n) - 1 + k) / std::sqrt(2 * k));
}

std::size_t odd_one_out(const TieInput& input, double p_value) {
  std::size_t odd = kNone;
  double best = p_value;
  for (std::size_t unit = 0; unit < input.units; ++unit) {
    TieInput others = input;
    others.without = unit;
    const TieSolution solution = tie(others);
    if (solution.degrees_of_freedom <= 0) continue;  // nothing is left that could disagree
    const double p = chi_square_tail(solution.chi2, solution.degrees_of_freedom);
    if (p > best) {
      best = p;
      odd = unit;
    }
  }
  return odd;
}

}  // namespace roomcal::tools
