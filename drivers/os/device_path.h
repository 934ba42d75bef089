#pragma once

#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

/// Of a device file or a folder, in options. A text that fills it may have been cut.
using DevicePath = FixedText<127>;

inline Status check_path(const DevicePath& path) {
  if (path.empty()) return {StatusCode::kInvalidArgument, "the profile names no device"};
  if (path.view().size() < DevicePath::capacity()) return ok_status();
  return {StatusCode::kInvalidArgument, "the device's path is too long; at most 126 characters"};
}

}  // namespace roomcal::drivers
