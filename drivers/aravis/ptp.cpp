#include "drivers/aravis/ptp.h"

#include <array>

namespace roomcal::drivers {

const char* to_string(PtpState state) {
  constexpr std::array<const char*, 6> kNames = {"none", "off", "converging", "slave", "master", "faulty"};
  const auto i = static_cast<std::size_t>(state);
  return i < kNames.size() ? kNames[i] : "unknown";
}

PtpState ptp_state_of(std::string_view status) {
  if (status == "Slave") return PtpState::kSlave;
  if (status == "Master") return PtpState::kMaster;
  if (status == "Faulty") return PtpState::kFaulty;
  if (status == "Disabled") return PtpState::kOff;
  // Initializing, Listening, PreMaster, Uncalibrated, Passive.
  return PtpState::kConverging;
}

PtpState read_ptp(Features& features) {
  const bool newer = features.has("PtpEnable");
  const char* enable = newer ? "PtpEnable" : "GevIEEE1588";
  const FixedText<63> enabled = features.get(enable);
  if (enabled.empty()) return PtpState::kNone;
  if (enabled.view() == "false" || enabled.view() == "0") return PtpState::kOff;
  // Where there is a latch, the status is as of the last time that it was pulled.
  features.execute(newer ? "PtpDataSetLatch" : "GevIEEE1588DataSetLatch");
  const char* status = newer ? "PtpStatus" : "GevIEEE1588Status";
  return features.has(status) ? ptp_state_of(features.get(status).view()) : PtpState::kConverging;
}

}  // namespace roomcal::drivers
