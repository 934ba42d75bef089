#pragma once

#include <cstdint>
#include <string_view>

#include "drivers/aravis/features.h"

namespace roomcal::drivers {

/// How a camera's clock stands to those of its network.
enum class PtpState : uint8_t {
  kNone,        ///< the camera has no PTP
  kOff,         ///< it has, and it is off
  kConverging,  ///< it listens, or does not yet agree with its master
  kSlave,       ///< it follows its master
  kMaster,      ///< the others follow it
  kFaulty,
};
/// "none", "off", "converging", "slave", "master", "faulty".
const char* to_string(PtpState state);

/// By the words of SFNC's PtpStatus and GevIEEE1588Status.
PtpState ptp_state_of(std::string_view status);
/// Whether the stamps are of the network's clock.
constexpr bool is_locked(PtpState state) { return state == PtpState::kSlave || state == PtpState::kMaster; }

/// Asks the camera; a few exchanges with it.
PtpState read_ptp(Features& features);

}  // namespace roomcal::drivers
