#pragma once

#include <filesystem>
#include <vector>

#include "tools/simulate/shot.h"

namespace roomcal::tools {

/// How the pictures are stored.
struct PictureFormat {
  int jpeg_quality = 0;  ///< 0: PNG
};

/// @throws ToolError naming the path.
void write_picture(const Picture& picture, const std::string& camera, const PictureFormat& format,
                   const std::filesystem::path& folder);

/// camchain.yaml (Kalibr, intrinsics only), nominal.json (mounting by the drawing), truth.json (all that is true).
/// @throws ToolError naming the path.
void write_shot_facts(const Scene& scene, const Stand& stand, const std::vector<Picture>& pictures,
                      const ShotOptions& options, const std::filesystem::path& folder);

}  // namespace roomcal::tools
