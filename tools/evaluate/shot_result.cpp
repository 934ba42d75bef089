#include "tools/evaluate/shot_result.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <Eigen/Cholesky>

namespace roomcal::tools {

namespace {

/// Size of an error in units of the sigma that is predicted along it.
double sigmas(const Vec3& error, const Mat33& cov) {
  const double variance = error.dot(cov * error) / error.squaredNorm();
  return error.norm() / std::sqrt(variance);
}

Vec6 error_of(const SE3& T_hat, const SE3& T_true) { return se3_log(T_hat.inverse() * T_true); }

}  // namespace

void ExtrinsicErrors::add(const SE3& T_hat, const SE3& T_true, const Mat66& cov) {
  const Vec6 error = error_of(T_hat, T_true);
  const double deg = rad_to_deg(error.tail<3>().norm()), m = error.head<3>().norm();
  square_m2 += m * m;
  square_deg2 += deg * deg;
  worst_m = std::max(worst_m, m);
  worst_deg = std::max(worst_deg, deg);
  nees += error.dot(cov.ldlt().solve(error));
  ++count;
}

void ExtrinsicErrors::add(const ExtrinsicErrors& other) {
  square_m2 += other.square_m2;
  square_deg2 += other.square_deg2;
  worst_m = std::max(worst_m, other.worst_m);
  worst_deg = std::max(worst_deg, other.worst_deg);
  nees += other.nees;
  count += other.count;
}

ShotResult result_of(const calib::Outcome& outcome, const TrustDevice& device) {
  ShotResult result;
  result.accepted = calib::may_write(outcome.verdict);
  for (const Reason& reason : outcome.reasons) result.reasons.insert(class_of(std::string(reason.view())));
  if (!result.accepted) return result;
  const std::size_t reference = device.device.reference;
  for (const calib::LocatedSensor& sensor : calib::located_sensors(outcome)) {
    const std::size_t number = device.number_of(sensor.name.view());
    if (!sensor.in_rig || number == reference) continue;
    const SE3& T_true = device.T_rig_sensor[number];
    (number < device.device.cameras.size() ? result.cameras : result.lidars)
        .add(sensor.T_rig_sensor, T_true, sensor.cov_rig_sensor);
    const Vec6 error = error_of(sensor.T_rig_sensor, T_true);
    const Mat66& cov = sensor.cov_rig_sensor;
    if (error.head<3>().norm() > kWrong_m)
      result.worst_sigmas = std::max(result.worst_sigmas, sigmas(error.head<3>(), cov.topLeftCorner<3, 3>()));
    if (error.tail<3>().norm() > deg_to_rad(kWrong_deg))
      result.worst_sigmas = std::max(result.worst_sigmas, sigmas(error.tail<3>(), cov.bottomRightCorner<3, 3>()));
  }
  result.wrong = !(result.worst_sigmas <= kWrongSigmas);  // NaN too
  return result;
}

std::string class_of(const std::string& reason) {
  const std::size_t name = reason.find(": ");
  std::string text = name == reason.npos ? reason : reason.substr(name + 2);
  text = text.substr(0, text.find(": "));
  std::string out;
  for (const char c : text) {
    const bool number = std::isdigit(static_cast<unsigned char>(c)) != 0 || (c == '.' && out.ends_with('#'));
    if (!number) {
      out += c;
    } else if (!out.ends_with('#')) {
      out += '#';
    }
  }
  return out;
}

void ShotTally::add(const ShotResult& result) {
  ++shots;
  accepted += result.accepted ? 1 : 0;
  wrong += result.wrong ? 1 : 0;
  worst_sigmas = std::max(worst_sigmas, result.worst_sigmas);
  cameras.add(result.cameras);
  lidars.add(result.lidars);
  for (const std::string& reason : result.reasons) {
    if (result.accepted) {
      accepted_with.insert(reason);
    } else {
      ++refused_with[reason];
    }
  }
}

std::vector<std::pair<std::string, int>> ShotTally::refusals() const {
  std::vector<std::pair<std::string, int>> sorted;
  for (const auto& [reason, count] : refused_with)
    if (!accepted_with.contains(reason)) sorted.emplace_back(reason, count);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return sorted;
}

}  // namespace roomcal::tools
