#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "runtime/camera/parameters.h"
#include "runtime/math/se3.h"

namespace roomcal::tools {

inline constexpr std::size_t kNone = SIZE_MAX;

/// One unit (sensor of the device) as one shot alone sees it.
struct Sighting {
  std::size_t shot = 0;
  std::size_t unit = 0;
  SE3 T_room_sensor;
  std::size_t lens = kNone;  ///< number in TieInput::lens, if its intrinsics were refined
};

/// A drawing's word on a unit: T_rig_unit, sigmas per axis.
struct TieMount {
  std::size_t unit = 0;
  SE3 T_rig_unit;
  double sigma_t_m = 0;
  double sigma_rot_rad = 0;
};

/// Several shots of one device, each solved on its own, and what their errors share.
struct TieInput {
  std::size_t shots = 0;
  std::size_t units = 0;
  std::size_t reference = 0;  ///< unit whose frame is the rig's
  std::vector<Sighting> sightings;
  std::vector<camera::Parameters> lens;  ///< parameters as refined, by Sighting::lens
  /// Joint covariance of all sightings' poses (6 each, right perturbation) and then of all lenses' parameters (8 each);
  /// a parameter that is held has zero rows.
  Eigen::MatrixXd cov;
  std::vector<TieMount> mounts;
  std::size_t without = kNone;  ///< a unit to leave out
};

/// The device as all shots together see it.
struct TieSolution {
  std::vector<bool> known;  ///< by unit: tied to the reference by some shot
  std::vector<SE3> T_rig_unit;
  std::vector<camera::Parameters> lens;  ///< by unit; zero where none was refined
  std::vector<bool> placed;              ///< by shot
  std::vector<SE3> T_room_rig;           ///< by shot
  /// Of T_rig_unit (6 each; zero for the reference), then of lens (8 each), then of T_room_rig (6 each), all right
  /// perturbations; zero rows for what is not known.
  Eigen::MatrixXd cov;
  /// The same without the mounts: what the shots tell themselves.
  Eigen::MatrixXd cov_free;
  double chi2 = 0;  ///< by which the shots contradict each other
  int degrees_of_freedom = 0;
};

/// Ties sightings together: every unit sits in the same place on the rig in all shots, every lens is the same.
///
/// With e_k = log(T_room_sensor_k^-1 T_room_rig[shot] T_rig_unit[unit]) and the lenses' differences stacked into e,
/// minimizes  e' cov^-1 e + sum |log(mount^-1 T_rig_unit)|^2.  What single shots leave in cov is all that they know, so
/// nothing is lost to solving them one by one; errors that they share through the map are in cov's blocks off the
/// diagonal. Open directions of a LiDAR are wide in cov and add less than one to chi2 for each degree of freedom.
/// A lens is in every shot with its prior: its caller has given each view of n a prior wider by sqrt(n).
/// @throws ToolError if the covariance is not positive definite.
/// Cost: cubic in 6 x sightings.
TieSolution tie(const TieInput& input);

/// P(chi-square with n degrees of freedom > x) (Wilson, Hilferty 1931).
double chi_square_tail(double x, int n);

/// The unit without which the shots contradict each other least by what chance would have it; kNone if leaving out any
/// one of them does not make them agree.
std::size_t odd_one_out(const TieInput& input, double p_value);

}  // namespace roomcal::tools
