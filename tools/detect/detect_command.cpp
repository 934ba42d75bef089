#include "tools/detect/detect_command.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "runtime/marker/detector.h"
#include "tools/common/detection_json.h"
#include "tools/common/draw.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/image_io.h"
#include "tools/common/progress.h"

namespace roomcal::tools {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

struct Options {
  std::vector<std::string> images;
  std::string json_file;
  std::string draw_folder;
};

// More than any room has on one image; beyond it detect() says kCapacity and we say so.
constexpr std::size_t kMaxMarkers = 4096;

/// @param[out] complete  false where the detector's tables were full: what it found is valid, but not all.
std::vector<marker::Detection> detect_in(const cv::Mat& grey, const std::string& file, bool& complete) {
  std::vector<std::byte> memory(marker::detector_scratch_bytes(grey.cols, grey.rows));
  Arena scratch(memory);
  std::vector<marker::Detection> detections(kMaxMarkers);
  std::size_t count = 0;
  const Status status = marker::detect(view(grey), {}, scratch, detections, count);
  complete = status.code() != StatusCode::kCapacity;
  if (complete) require(status, file);
  detections.resize(count);
  return detections;
}

/// Pictures of one call may share a name; numbering keeps them apart.
fs::path picture_path(const Options& options, std::size_t i) {
  const fs::path file(options.images[i]);
  const bool unique = std::count_if(options.images.begin(), options.images.end(), [&](const std::string& other) {
                        return fs::path(other).stem() == file.stem();
                      }) == 1;
  return fs::path(options.draw_folder) / (file.stem().string() + (unique ? "" : fmt::format("_{}", i)) + "_rings.png");
}

/// @return false if an image held more than the detector's tables: not all of it is in the results.
bool run(const Options& options) {
  bool all_complete = true;
  json report = {{"images", json::array()}};
  if (!options.draw_folder.empty()) make_folder(options.draw_folder);
  Progress progress("detect", options.images.size());
  for (std::size_t i = 0; i < options.images.size(); ++i) {
    const std::string& file = options.images[i];
    const cv::Mat grey = read_grey(file);
    bool complete = true;
    const std::vector<marker::Detection> detections = detect_in(grey, file, complete);
    if (!complete) {
      all_complete = false;
      fmt::print(stderr,
                 "roomcal: {}: more ring-like shapes than the detector keeps, some are left out; is it noise?\n", file);
    }
    json markers = json::array();
    std::size_t usable = 0;
    for (const marker::Detection& d : detections) {
      markers.push_back(to_json(d));
      usable += d.status == marker::DetectionStatus::kOk;
    }
    fmt::print("{}: {} markers, {} of them usable\n", file, detections.size(), usable);
    report["images"].push_back(
        {{"file", file}, {"width", grey.cols}, {"height", grey.rows}, {"markers", std::move(markers)}});
    if (!options.draw_folder.empty()) {
      cv::Mat picture = canvas(grey);
      draw_detections(picture, detections);
      write_image(picture_path(options, i), picture);
    }
    progress.step();
  }
  if (!options.json_file.empty()) write_atomic(options.json_file, report.dump(1) + "\n");
  return all_complete;
}

}  // namespace

void add_detect_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("detect", "find ring markers in images");
  command->add_option("images", options->images, "image files (PNG, JPEG, PGM)")->required();
  command->add_option("--json", options->json_file, "write the detections to this file");
  command->add_option("--draw", options->draw_folder, "write annotated pictures into this folder");
  // Seeing no marker is an answer; having left some out is none.
  command->callback([options, &exit_code] { exit_code = run(*options) ? 0 : 2; });
}

}  // namespace roomcal::tools
