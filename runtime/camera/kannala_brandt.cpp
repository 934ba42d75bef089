#include "runtime/camera/kannala_brandt.h"

#include <cmath>

#include "runtime/camera/field_limit.h"
#include "runtime/math/types.h"

namespace roomcal::camera {

namespace {

// Straight behind, every direction of the plane meets: the azimuth is lost there.
constexpr double kMaxAngleRad = kPi - 1e-4;

}  // namespace

ValueAndSlope KannalaBrandt::radius(double theta_rad) const {
  const double t2 = theta_rad * theta_rad;
  return {theta_rad * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))),
          1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])))};
}

double KannalaBrandt::max_angle_rad(double max_distorted_radius) const {
  const double slope_in_t2[] = {1 - kMinSlope, 3 * k[0], 5 * k[1], 7 * k[2], 9 * k[3]};
  const double fold_rad = std::sqrt(first_non_positive(slope_in_t2, kMaxAngleRad * kMaxAngleRad));
  const double reach[] = {max_distorted_radius, -1, 0, -k[0], 0, -k[1], 0, -k[2], 0, -k[3]};
  return first_non_positive(reach, fold_rad);
}

double KannalaBrandt::angle_rad(double r, double max_angle_rad) const {
  if (!(r <= radius(max_angle_rad).value * (1 + kEdgeTolerance))) return -1;
  return solve_radial([this](double theta_rad) { return radius(theta_rad); }, r, max_angle_rad);
}

}  // namespace roomcal::camera
