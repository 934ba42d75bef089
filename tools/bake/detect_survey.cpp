#include "tools/bake/detect_survey.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "runtime/marker/detector.h"
#include "tools/common/error.h"
#include "tools/common/image_io.h"
#include "tools/common/progress.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxMarkers = 1024;  // of one image; more is said, never dropped silently

void check_size(const cv::Mat& grey, const camera::Intrinsics& k, const fs::path& path) {
  if (grey.cols == k.width_px && grey.rows == k.height_px) return;
  throw ToolError(fmt::format("{}: {} x {}, but the calibration is for {} x {}: another camera or a scaled image?",
                              path.string(), grey.cols, grey.rows, k.width_px, k.height_px));
}

class SurveyDetector {
 public:
  SurveyDetector(const std::vector<std::pair<fs::path, fs::path>>& pairs, const StereoRig& rig)
      : pairs_(pairs), rig_(rig), progress_("detect", pairs.size()), remarks_(pairs.size()) {
    survey_.views.resize(pairs.size());
  }

  Survey run() {
    std::vector<std::thread> helpers;
    for (unsigned t = 1; t < std::thread::hardware_concurrency(); ++t) helpers.emplace_back([this] { work(); });
    work();
    for (std::thread& helper : helpers) helper.join();
    if (error_) std::rethrow_exception(error_);
    for (const auto& lines : remarks_) survey_.remarks.insert(survey_.remarks.end(), lines.begin(), lines.end());
    return std::move(survey_);
  }

 private:
  void work() {
    try {
      std::vector<std::byte> memory;
      for (std::size_t i = next_++; i < pairs_.size(); i = next_++) {
        survey_.views[i].name = pairs_[i].first.stem().string();
        for (const Side side : kBothSides) search(i, side, memory);
        const std::lock_guard lock(mutex_);
        progress_.step();
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      next_ = pairs_.size();
    }
  }

  void search(std::size_t i, Side side, std::vector<std::byte>& memory) {
    const fs::path& path = side == kLeft ? pairs_[i].first : pairs_[i].second;
    cv::Mat grey;
    try {
      grey = read_grey(path);
    } catch (const ToolError& error) {
      remarks_[i].push_back(std::string(error.what()) + "; left out");
      return;
    }
    check_size(grey, rig_.cameras[side].intrinsics(), path);
    memory.resize(std::max(memory.size(), marker::detector_scratch_bytes(grey.cols, grey.rows)));
    Arena scratch(memory);
    std::vector<marker::Detection> found(kMaxMarkers);
    std::size_t count = 0;
    require(marker::detect(view(grey), {}, scratch, found, count), path.string());
    for (std::size_t d = 0; d < count; ++d) {
      if (found[d].status != marker::DetectionStatus::kOk) continue;
      survey_.views[i].seen[side].push_back({found[d].centre_px, found[d].cov_px2, found[d].ellipse});
    }
  }

  const std::vector<std::pair<fs::path, fs::path>>& pairs_;
  const StereoRig& rig_;
  Progress progress_;
  Survey survey_;
  std::vector<std::vector<std::string>> remarks_;
  std::atomic<std::size_t> next_{0};
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

Survey detect_survey(const std::vector<std::pair<fs::path, fs::path>>& pairs, const StereoRig& rig) {
  return SurveyDetector(pairs, rig).run();
}

}  // namespace roomcal::tools
