#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "runtime/camera/intrinsics.h"
#include "runtime/store/record.h"

namespace roomcal::tools {

/// A camera's `intrinsics` in a result or an exported record. @throws ToolError or an exception of the JSON library.
camera::Intrinsics parse_intrinsics(const nlohmann::json& in);

/// The record in a result of `roomcal calibrate --json`.
/// @param name  of the file, for messages.
/// @throws ToolError for what is not such a result, and for a verdict that may not be stored.
store::Record parse_result(const std::string& name, const std::string& text);

}  // namespace roomcal::tools
