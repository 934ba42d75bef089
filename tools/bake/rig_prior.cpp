#include "tools/bake/rig_prior.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "tools/bake/bundle_cost.h"

namespace roomcal::tools {

std::unique_ptr<ceres::CostFunction> make_extrinsics_prior(const SE3& given, const RigPrior& prior) {
  const Vec3 along = given.t.normalized();
  const Vec3 across = along.unitOrthogonal();
  Mat33 axes;
  axes << along.transpose(), across.transpose(), along.cross(across).transpose();
  const Vec3 sigma_m(prior.baseline * given.t.norm(), prior.baseline_across_m, prior.baseline_across_m);
  Mat66 whitening = Mat66::Zero();
  whitening.topLeftCorner<3, 3>() = sigma_m.cwiseInverse().asDiagonal() * axes;
  whitening.bottomRightCorner<3, 3>() = Mat33::Identity() / prior.rotation_rad;
  return std::make_unique<RigPriorCost>(given, whitening);
}

std::unique_ptr<ceres::CostFunction> make_intrinsics_prior(const camera::Intrinsics& given, const RigPrior& prior) {
  IntrinsicsPriorCost::Values sigma;
  sigma.fill(prior.radial);
  sigma[0] = prior.focal * given.fx_px;
  sigma[1] = prior.aspect;
  sigma[2] = sigma[3] = prior.principal_px;
  if (given.model == camera::Model::kPinholeRadtan) sigma[6] = sigma[7] = prior.radial / 20;
  return std::make_unique<IntrinsicsPriorCost>(to_values(given), sigma);
}

bool is_undistorted(const camera::Intrinsics& intrinsics) {
  return std::all_of(intrinsics.distortion.begin(), intrinsics.distortion.end(), [](double d) { return d == 0; });
}

}  // namespace roomcal::tools
