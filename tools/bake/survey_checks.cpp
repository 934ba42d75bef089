#include "tools/bake/survey_checks.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

/// Sightings of the left images that found a partner.
std::size_t count_partnered(const std::vector<std::vector<StereoPoint>>& stereo) {
  std::size_t count = 0;
  for (const std::vector<StereoPoint>& points : stereo) {
    std::set<std::size_t> left;
    for (const StereoPoint& point : points) left.insert(point.left);
    count += left.size();
  }
  return count;
}

}  // namespace

void check_stereo(const Survey& survey, const StereoRig& rig, const std::vector<std::vector<StereoPoint>>& stereo,
                  const StereoMatchOptions& options) {
  std::array<std::size_t, 2> sightings{};
  for (const StereoView& view : survey.views) {
    for (const Side side : kBothSides) sightings[side] += view.seen[side].size();
  }
  for (const Side side : kBothSides) {
    if (sightings[side] > 0) continue;
    throw ToolError(fmt::format("{}: no markers in any {} image; are these pictures of the marker room, in focus?",
                                survey.source, side == kLeft ? "left" : "right"));
  }
  const std::size_t partnered = count_partnered(stereo);
  if (2 * partnered >= std::min(sightings[kLeft], sightings[kRight])) return;
  std::size_t partnered_swapped = 0;
  for (const StereoView& view : survey.views) {
    const StereoView exchanged{view.name, {view.seen[kRight], view.seen[kLeft]}};
    partnered_swapped += count_partnered({match_stereo(rig, exchanged, options)});
  }
  // A foreign calibration finds a few chance partners either way; only exchanging that mends most of them is the cause.
  if (2 * partnered_swapped >= std::min(sightings[kLeft], sightings[kRight])) {
    throw ToolError(
        fmt::format("{}: left and right are swapped: exchange the folders (or the cameras in the "
                    "calibration); {} sightings find a partner that way, {} as given",
                    survey.source, partnered_swapped, partnered));
  }
  throw ToolError(
      fmt::format("{}: only {} of {} sightings find a partner in the other image: the stereo calibration "
                  "does not belong to this survey, or the pictures of a pair were not taken together",
                  survey.source, partnered, std::min(sightings[kLeft], sightings[kRight])));
}

void check_one_room(const Survey& survey, const std::vector<Reconstruction>& maps) {
  if (maps.size() < 2) return;
  constexpr std::size_t kFewViews = 5;
  const std::size_t second = maps[1].order.size();
  if (second < kFewViews || 10 * second < maps[0].order.size()) return;
  std::vector<std::size_t> views = maps[1].order;
  std::sort(views.begin(), views.end());
  throw ToolError(
      fmt::format("{}: the survey falls into parts that share no markers, two rooms or a walk with a gap: "
                  "{} pairs fit together, {} others do too ({}); bake one room at a time, or add pairs that "
                  "see both parts",
                  survey.source, maps[0].order.size(), second, name_views(survey, views)));
}

std::string name_views(const Survey& survey, const std::vector<std::size_t>& views, std::size_t at_most) {
  std::string names;
  for (std::size_t i = 0; i < std::min(at_most, views.size()); ++i) {
    names += (i > 0 ? ", " : "") + survey.views[views[i]].name;
  }
  if (views.size() > at_most) names += fmt::format(" and {} more", views.size() - at_most);
  return names;
}

}  // namespace roomcal::tools
