#pragma once

#include <filesystem>

#include "runtime/store/record.h"

namespace roomcal::tools {

/// A record file: the bytes that a slot of the device's store begins with.
/// @throws ToolError naming the file and why it was refused.
store::Record read_record(const std::filesystem::path& path);

/// @throws ToolError for a record that may not be stored, or a file that cannot be written.
void write_record(const std::filesystem::path& path, const store::Record& record);

}  // namespace roomcal::tools
