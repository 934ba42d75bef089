#include "tools/simulate/shot_files.h"

#include <array>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <opencv2/imgcodecs.hpp>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/simulate/shot_truth.h"

namespace roomcal::tools {

namespace {

std::string kalibr_camera(const TrueCamera& camera) {
  const camera::Intrinsics& lens = camera.camera.intrinsics();
  const bool fisheye = lens.model == camera::Model::kKannalaBrandt;
  return fmt::format(
      "{0}:\n  camera_model: pinhole\n  distortion_coeffs: [{1:.17g}]\n  distortion_model: {2}\n"
      "  intrinsics: [{3:.17g}, {4:.17g}, {5:.17g}, {6:.17g}]\n  resolution: [{7}, {8}]\n  rostopic: /{0}/image_raw\n",
      camera.name, fmt::join(lens.distortion, ", "), fisheye ? "equidistant" : "radtan", lens.fx_px, lens.fy_px,
      lens.cx_px, lens.cy_px, lens.width_px, lens.height_px);
}

}  // namespace

void write_picture(const Picture& picture, const std::string& camera, const PictureFormat& format,
                   const std::filesystem::path& folder) {
  make_folder(folder);
  constexpr std::array kExtensions = {".png", ".jpg", ".pgm"};
  const std::filesystem::path path = folder / (camera + kExtensions.at(static_cast<std::size_t>(format.file)));
  const std::vector<int> settings = format.file == ImageFile::kJpeg
                                        ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, format.jpeg_quality}
                                        : std::vector<int>{};
  if (!cv::imwrite(path.string(), picture.image, settings)) {
    throw ToolError(path.string() + ": cannot be written; check the folder and the space left");
  }
}

std::string camchain_text(const Stand& stand) {
  std::string camchain;
  for (const TrueCamera& camera : stand.cameras) camchain += kalibr_camera(camera);
  return camchain;
}

void write_shot_facts(const Scene& scene, const Stand& stand, const ShotFacts& facts, const ShotOptions& options,
                      const std::filesystem::path& folder) {
  write_atomic(folder / "camchain.yaml", camchain_text(stand));
  write_atomic(folder / "nominal.json", nominal_json(stand, options).dump(1) + "\n");
  write_atomic(folder / "truth.json", truth_json(scene, stand, facts, options).dump(1) + "\n");
}

}  // namespace roomcal::tools
