#include "tools/bake/survey_reader.h"

#include <algorithm>
#include <cctype>
#include <map>

#include <fmt/format.h>

#include "tools/bake/detect_survey.h"
#include "tools/bake/survey_json.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/map/anchor_room_file.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

bool is_image(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg" || ending == ".pgm";
}

/// Image files of one side by stem.
std::map<std::string, fs::path> list_images(const fs::path& folder) {
  std::map<std::string, fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file() || !is_image(entry.path())) continue;
    if (!images.emplace(entry.path().stem().string(), entry.path()).second) {
      throw ToolError(
          fmt::format("{}: two images are called {}; keep one", folder.string(), entry.path().stem().string()));
    }
  }
  if (images.empty()) throw ToolError(folder.string() + ": no PNG, JPEG or PGM in it");
  return images;
}

std::array<fs::path, 2> find_sides(const fs::path& folder) {
  for (const auto& [left, right] : {std::pair{"cam0", "cam1"}, std::pair{"left", "right"}}) {
    const bool has_left = fs::is_directory(folder / left), has_right = fs::is_directory(folder / right);
    if (has_left && has_right) return {folder / left, folder / right};
    if (has_left != has_right) {
      throw ToolError(fmt::format("{}: {}/ is missing beside {}/; a survey needs both sides", folder.string(),
                                  has_left ? right : left, has_left ? left : right));
    }
  }
  throw ToolError(folder.string() + ": no cam0/ and cam1/ (or left/ and right/) in it");
}

/// Key points of the paper's file: undistorted already, without covariance.
Survey from_anchor_room(const std::string& name) {
  Survey survey;
  survey.source = name;
  for (const AnchorFrame& frame : parse_anchor_room(name, read_text(name)).frames) {
    StereoView view;
    view.name = std::to_string(frame.id);
    for (const Vec2& px : frame.left_px) view.seen[kLeft].push_back({px, Mat22::Identity(), {}});
    for (const Vec2& px : frame.right_px) view.seen[kRight].push_back({px, Mat22::Identity(), {}});
    survey.views.push_back(std::move(view));
  }
  return survey;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    std::size_t end_i = i, end_j = j;
    while (end_i < a.size() && digit(a[end_i])) ++end_i;
    while (end_j < b.size() && digit(b[end_j])) ++end_j;
    if (end_i - i != end_j - j) return end_i - i < end_j - j;
    if (const int order = a.compare(i, end_i - i, b, j, end_j - j); order != 0) return order < 0;
    i = end_i, j = end_j;
  }
  return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}

std::vector<std::pair<fs::path, fs::path>> pair_images(const fs::path& folder, std::vector<std::string>& remarks) {
  const std::array<fs::path, 2> sides = find_sides(folder);
  const auto left = list_images(sides[kLeft]), right = list_images(sides[kRight]);
  std::vector<std::string> names;
  for (const auto& [name, path] : left) {
    if (right.contains(name))
      names.push_back(name);
    else
      remarks.push_back(path.string() + ": no partner of this name on the right; left out");
  }
  for (const auto& [name, path] : right) {
    if (!left.contains(name)) remarks.push_back(path.string() + ": no partner of this name on the left; left out");
  }
  if (2 * names.size() < std::min(left.size(), right.size())) {
    throw ToolError(
        fmt::format("{}: {} images left, {} right, {} of them in both; the two images of a pair must have "
                    "the same name",
                    folder.string(), left.size(), right.size(), names.size()));
  }
  std::sort(names.begin(), names.end(), natural_less);
  std::vector<std::pair<fs::path, fs::path>> pairs;
  for (const std::string& name : names) pairs.emplace_back(left.at(name), right.at(name));
  return pairs;
}

Survey read_survey(const fs::path& path, const StereoRig& rig) {
  if (fs::is_directory(path)) {
    std::vector<std::string> remarks;
    const auto pairs = pair_images(path, remarks);
    Survey survey = detect_survey(pairs, rig);
    survey.source = path.string();
    survey.remarks.insert(survey.remarks.begin(), remarks.begin(), remarks.end());
    return survey;
  }
  if (path.extension() == ".json") return parse_survey_json(path.string(), read_text(path), rig);
  if (path.extension() == ".yaml" || path.extension() == ".yml") return from_anchor_room(path.string());
  if (!fs::exists(path)) throw ToolError(path.string() + ": no such file or folder");
  throw ToolError(path.string() +
                  ": not a survey: give a folder with cam0/ and cam1/, the paper's map YAML, or saved "
                  "detections (*.json)");
}

}  // namespace roomcal::tools
