#pragma once

#include <string>

#include "runtime/store/record.h"

namespace roomcal::tools {

/// The record in a result of `roomcal calibrate --json`.
/// @param name  of the file, for messages.
/// @throws ToolError for what is not such a result, and for a verdict that may not be stored.
store::Record parse_result(const std::string& name, const std::string& text);

}  // namespace roomcal::tools
