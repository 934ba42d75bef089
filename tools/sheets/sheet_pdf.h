#pragma once

#include <filesystem>

#include "tools/sheets/sheet_page.h"

namespace roomcal::tools {

/// Writes sheets number `first` to `first + count - 1`, one a page.
/// @throws ToolError naming the path if it cannot be written.
void write_sheets(const SheetPage& page, int first, int count, const std::filesystem::path& path);

}  // namespace roomcal::tools
