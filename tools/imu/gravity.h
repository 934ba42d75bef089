#pragma once

#include <vector>

#include "runtime/math/so3.h"
#include "runtime/math/types.h"

namespace roomcal::tools {

/// An IMU at rest in one place: what it feels, and how the rig is turned there.
struct Stance {
  Mat33 R_room_rig = Mat33::Identity();
  Vec3 held_up_mps2 = Vec3::Zero();  ///< mean specific force, IMU frame: +g upwards
  Vec3 sigma_mps2 = Vec3::Zero();    ///< of the mean, per axis
};

/// What is known before.
struct GravityPrior {
  bool mounted = false;  ///< whether R_rig_imu is known from a drawing
  Mat33 R_rig_imu = Mat33::Identity();
  double mount_sigma_rad = 0;                    ///< per axis, if mounted
  double bias_sigma_mps2 = 0.02;                 ///< of the accelerometer, per axis: 2 mg
  double level_sigma_rad = deg_to_rad(0.2);      ///< by which the room's z may be off plumb, about x and about y
  double attitude_sigma_rad = deg_to_rad(0.01);  ///< of R_room_rig in each stance, per axis
  double gravity_mps2 = 9.80665;
  double gravity_sigma_mps2 = 0.03;  ///< pole to equator
};

/// How an IMU sits on the rig, as far as gravity tells.
struct ImuRotation {
  Mat33 R_rig_imu = Mat33::Identity();
  Mat33 cov = Mat33::Zero();  ///< right perturbation, IMU frame, rad^2; with the drawing, where there is one
  Vec3 bias_mps2 = Vec3::Zero(), bias_sigma_mps2 = Vec3::Zero();
  int seen = 0;                    ///< degrees of freedom that gravity tells: 2 or 3
  Vec3 unseen_rig = Vec3::Zero();  ///< unit axis of the third, if it is not seen
  double unseen_sigma_rad = 0;     ///< about it, from gravity alone
  double chi2 = 0;                 ///< of all measurements and priors, but for the drawing
  int degrees_of_freedom = 0;
};

/// The rotation of an IMU from where gravity is, in one stance or several.
///
/// In every stance  held_up = R_imu_rig R_rig_room exp(attitude) (exp(level) g z) + bias + noise,  with priors on bias,
/// level, g and attitude: two equations on three unknowns, as gravity says nothing about turning around it. Stances in
/// which the rig leans differently see the third; standing upright in many places does not.
/// A direction with more than 1 degree from gravity alone counts as not seen; a drawing then carries it, at its own
/// width; without one it keeps half a radian.
/// @throws ToolError if there is no stance, or what is felt is not gravity (10 % off, or beyond chance): the device
///         moved, or these are not m/s^2.
ImuRotation find_imu_rotation(const std::vector<Stance>& stances, const GravityPrior& prior);

}  // namespace roomcal::tools
