#include "runtime/calib/compare_installed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace roomcal::calib {

namespace {

/// One sensor as the installed record has it and as this shot does.
struct Both {
  const store::SensorRecord* installed = nullptr;
  LocatedSensor now;
  std::size_t change = 0;  ///< number in InstalledCheck::sensors
};
using BothList = FixedVector<Both, kMaxSensors>;

/// T_a_b of the installed record. It keeps no covariance between sensors: their errors count as independent, which
/// makes pairs without the reference look less certain than they are, never more.
rig::RelativePose installed_pair(const store::SensorRecord& a, const store::SensorRecord& b) {
  rig::RelativePose pair;
  pair.T_a_b = a.T_rig_sensor.inverse() * b.T_rig_sensor;
  const Mat66 Ad = se3_adjoint(pair.T_a_b.inverse());
  pair.cov = b.cov_rig_sensor + Ad * a.cov_rig_sensor * Ad.transpose();
  return pair;
}

struct Delta {
  Vec6 xi = Vec6::Zero();
  Mat66 cov = Mat66::Zero();
  double chi2 = 0;
};

Delta difference(const rig::RigSolution& solution, const Both& a, const Both& b) {
  const rig::RelativePose then = installed_pair(*a.installed, *b.installed);
  const rig::RelativePose now = rig::relative_pose(solution, a.now.number, b.now.number);
  Delta delta;
  delta.xi = se3_log(then.T_a_b.inverse() * now.T_a_b);
  delta.cov = then.cov + now.cov;
  delta.chi2 = delta.xi.dot(delta.cov.ldlt().solve(delta.xi));
  return delta;
}

BothList gather(const Session& session, Outcome& outcome) {
  BothList both;
  InstalledCheck& check = outcome.installed;
  for (const store::SensorRecord& sensor : session.installed->sensors) {
    SensorChange change;
    change.name = sensor.name;
    if (!check.sensors.push_back(change)) break;
  }
  for (const LocatedSensor& now : located_sensors(outcome)) {
    if (!now.in_rig) continue;
    for (std::size_t i = 0; i < check.sensors.size(); ++i) {
      if (check.sensors[i].name.view() != now.name.view()) continue;
      check.sensors[i].comparable = true;
      static_cast<void>(both.push_back({session.installed->find(now.name.view()), now, i}));
    }
  }
  return both;
}

/// The sensor that disagrees: without it, the pairs of the others differ least.
std::size_t find_moved(const rig::RigSolution& solution, const BothList& both, std::size_t reference) {
  const std::size_t n = both.size();
  if (n == 2) return reference == 0 ? 1 : 0;
  std::array<double, kMaxSensors> of_pairs{};
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) {
      const double chi2 = difference(solution, both[a], both[b]).chi2;
      of_pairs[a] += chi2;
      of_pairs[b] += chi2;
    }
  // The sum over pairs without k is the whole sum less that over pairs with k.
  return static_cast<std::size_t>(std::max_element(of_pairs.begin(), of_pairs.begin() + n) - of_pairs.begin());
}

}  // namespace

double chi_square_6_tail(double x) {
  const double h = 0.5 * x;
  return x <= 0 ? 1 : std::exp(-h) * (1 + h + 0.5 * h * h);
}

void compare_installed(const Session& session, Outcome& outcome) {
  outcome.installed = {};
  if (session.installed == nullptr) return;
  InstalledCheck& check = outcome.installed;
  const BothList both = gather(session, outcome);
  const std::string_view reference_name = outcome.cameras[outcome.reference].name.view();
  std::size_t reference = both.size();
  for (std::size_t i = 0; i < both.size(); ++i)
    if (both[i].now.name.view() == reference_name) reference = i;
  if (reference == both.size() || both.size() < 2) return;  // nothing to compare against
  check.done = true;
  double least = 1;
  for (std::size_t i = 0; i < both.size(); ++i) {
    if (i == reference) continue;
    const Delta delta = difference(outcome.solution, both[reference], both[i]);
    SensorChange& change = check.sensors[both[i].change];
    change.delta = delta.xi;
    change.cov = delta.cov;
    change.p_value = chi_square_6_tail(delta.chi2);
    least = std::min(least, change.p_value);
  }
  check.p_value = std::min(1.0, least * static_cast<double>(both.size() - 1));
  check.moved = check.p_value < session.limits.moved_p_value;
  if (check.moved) check.moved_sensor = both[find_moved(outcome.solution, both, reference)].now.name;
}

}  // namespace roomcal::calib
