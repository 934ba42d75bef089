#pragma once

#include <string_view>

#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

/// What opens a camera, and what is said about the others.
struct FoundCamera {
  FixedText<255> id;       ///< of arv_open_device()
  FixedText<63> address;   ///< IPv4 of a GigE Vision camera, something else of a USB one
  FixedText<31> protocol;  ///< "GigEVision", "USB3Vision", "Fake"
  bool listed = true;      ///< false: nobody has answered from there yet
};

/// Looks on all networks and USB buses for the one camera whose serial number, id, MAC or address is `key`.
/// One at a time in the process: Aravis keeps the list in static memory. Takes a second, or nothing if somebody has
/// just looked.
/// An IPv4 address is also tried where nobody is listed under it: cameras in another network, and the second of two
/// whose maker, model and serial number are equal, which Aravis takes for one.
/// @param[out] seen  the cameras that are there, for a message.
/// @return kNotFound if there is none, or more than one: two cameras with one serial number.
Result<FoundCamera> find_camera(std::string_view key, FixedText<200>& seen);

}  // namespace roomcal::drivers
