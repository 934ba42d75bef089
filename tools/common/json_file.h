#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/files.h"

namespace roomcal::tools {

/// A JSON file, its keys in the file's order. @throws ToolError naming the path and what is wrong.
inline nlohmann::ordered_json read_json(const std::filesystem::path& path) {
  try {
    return nlohmann::ordered_json::parse(read_text(path));
  } catch (const nlohmann::json::exception& error) {
    throw ToolError(path.string() + ": is not JSON: " + error.what());
  }
}

}  // namespace roomcal::tools
