#pragma once

#include <filesystem>

#include "runtime/profile/profile.h"
#include "tools/common/files.h"

namespace roomcal::tools {

/// The bytes of a `*.profile` file (runtime/profile/format.h). What this makes was read back and written again to the
/// same bytes.
/// @throws ToolError "profile: ..." for what profile::check_profile() refuses.
AlignedBytes build_profile(const profile::Profile& profile);

/// @throws ToolError naming the file, why it was refused and the remedy.
profile::Profile read_profile(const std::filesystem::path& path);

}  // namespace roomcal::tools
