#pragma once

#include <string>

#include "tools/device/device.h"

namespace roomcal::tools {

/// Puts the CAD extrinsics of a `nominal.json` into a device that a camchain gave the cameras of, and adds its LiDARs.
///
///     {device: name, cameras: [name], lidars: [{name, kind, file}], sigma_rot_deg_per_axis, sigma_t_m_per_axis,
///      edges: [{to, from, T}]}      T (4x4 rows) maps points of `from` to `to`: T_to_from
///
/// T_rig_sensor is composed along the fewest edges from the rig frame; n edges add up to sqrt(n) sigmas. A mounting
/// from the camchain is replaced. Other keys are passed over.
/// @throws ToolError "where: path: ...": not JSON, a number that is not one, an edge to a sensor that is not listed,
///         a sensor that no edge connects to the rig frame, a camera that the camchain does not have.
void apply_nominal(const std::string& where, const std::string& text, Device& device);

}  // namespace roomcal::tools
