#pragma once

#include <filesystem>

#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// Writes markers.csv (id,x,y,z,nx,ny,nz,radius in metres), planes.json and room.json (all that is needed to render).
/// @throws ToolError naming the path.
void write_room(const Scene& scene, const std::filesystem::path& folder);

/// @param folder  as written by write_room. @throws ToolError naming the file and what is wrong.
Scene read_room(const std::filesystem::path& folder);

}  // namespace roomcal::tools
