#pragma once

#include <stdexcept>
#include <string>

#include "runtime/base/status.h"

namespace roomcal::tools {

/// What a tool tells its user and exits 1 with: names the thing and the remedy. Host programs may throw; the runtime
/// not.
class ToolError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws ToolError "<thing>: <code>: <detail>" unless ok.
inline void require(const Status& status, const std::string& thing) {
  if (!status.ok()) throw ToolError(thing + ": " + to_string(status.code()) + ": " + status.detail());
}

}  // namespace roomcal::tools
