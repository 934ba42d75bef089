#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tools/simulate/shot_truth.h"

namespace roomcal::tools {

enum class ImageFile : uint8_t { kPng, kJpeg, kPgm };

/// How the pictures are stored.
struct PictureFormat {
  ImageFile file = ImageFile::kPng;
  int jpeg_quality = 95;
};

/// @throws ToolError naming the path.
void write_picture(const Picture& picture, const std::string& camera, const PictureFormat& format,
                   const std::filesystem::path& folder);

/// The cameras' intrinsics as Kalibr writes them.
std::string camchain_text(const Stand& stand);

/// camchain.yaml (Kalibr, intrinsics only), nominal.json (mounting by the drawing), truth.json (all that is true).
/// @throws ToolError naming the path.
void write_shot_facts(const Scene& scene, const Stand& stand, const ShotFacts& facts, const ShotOptions& options,
                      const std::filesystem::path& folder);

}  // namespace roomcal::tools
