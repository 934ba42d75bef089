#pragma once

#include <filesystem>

#include "runtime/profile/profile.h"
#include "tools/common/files.h"

namespace roomcal::tools {

/// The bytes of a `*.profile` file (runtime/profile/format.h). What this makes was read back and is the same.
/// @throws ToolError for a profile that the runtime would refuse.
AlignedBytes build_profile(const profile::Profile& profile);

/// @throws ToolError naming the file and why it was refused.
profile::Profile read_profile(const std::filesystem::path& path);

}  // namespace roomcal::tools
