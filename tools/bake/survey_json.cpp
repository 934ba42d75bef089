#include "tools/bake/survey_json.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

constexpr const char* kFormat = "roomcal-survey-1";

json resolution_of(const StereoRig& rig) {
  json sizes = json::array();
  for (const Side side : kBothSides) {
    const camera::Intrinsics& k = rig.cameras[side].intrinsics();
    sizes.push_back({k.width_px, k.height_px});
  }
  return sizes;
}

json to_json(const Sighting& s) {
  json numbers{s.centre_px.x(), s.centre_px.y(), s.cov_px2(0, 0), s.cov_px2(0, 1), s.cov_px2(1, 1)};
  if (!s.ellipse) return numbers;
  for (const double v : {s.ellipse->major_px, s.ellipse->minor_px, s.ellipse->angle_rad, s.ellipse->centre_px.x(),
                         s.ellipse->centre_px.y()}) {
    numbers.push_back(v);
  }
  return numbers;
}

Sighting to_sighting(const json& numbers) {
  const auto n = numbers.get<std::vector<double>>();
  if (n.size() != 2 && n.size() != 5 && n.size() != 10) throw ToolError("a sighting has 2, 5 or 10 numbers");
  for (const double v : n) {
    if (!std::isfinite(v)) throw ToolError("a number is not finite");
  }
  Sighting sighting;
  sighting.centre_px = {n[0], n[1]};
  if (n.size() >= 5) {
    sighting.cov_px2 << n[2], n[3], n[3], n[4];
    if (!(n[2] > 0 && n[2] * n[4] > n[3] * n[3])) throw ToolError("a covariance is not positive definite");
  }
  if (n.size() == 10) sighting.ellipse = marker::Ellipse{{n[8], n[9]}, n[5], n[6], n[7]};
  return sighting;
}

}  // namespace

std::string to_survey_json(const Survey& survey, const StereoRig& rig) {
  json pairs = json::array();
  for (const StereoView& view : survey.views) {
    json sides = json::array({json::array(), json::array()});
    for (const Side side : kBothSides) {
      for (const Sighting& sighting : view.seen[side]) sides[side].push_back(to_json(sighting));
    }
    pairs.push_back({{"name", view.name}, {"left", sides[kLeft]}, {"right", sides[kRight]}});
  }
  return json{{"format", kFormat}, {"resolution_px", resolution_of(rig)}, {"pairs", pairs}}.dump() + "\n";
}

Survey parse_survey_json(const std::string& name, const std::string& text, const StereoRig& rig) {
  Survey survey;
  survey.source = name;
  try {
    const json file = json::parse(text);
    if (file.at("format") != kFormat) throw ToolError(fmt::format("format is not {}", kFormat));
    if (file.at("resolution_px") != resolution_of(rig)) {
      throw ToolError(fmt::format("resolution {} is not the calibration's {}", file.at("resolution_px").dump(),
                                  resolution_of(rig).dump()));
    }
    for (const json& pair : file.at("pairs")) {
      StereoView view;
      view.name = pair.at("name").get<std::string>();
      for (const json& s : pair.at("left")) view.seen[kLeft].push_back(to_sighting(s));
      for (const json& s : pair.at("right")) view.seen[kRight].push_back(to_sighting(s));
      survey.views.push_back(std::move(view));
    }
  } catch (const json::exception& error) {
    throw ToolError(fmt::format("{}: not a {} file: {}", name, kFormat, error.what()));
  } catch (const ToolError& error) {
    throw ToolError(fmt::format("{}: {}", name, error.what()));
  }
  if (survey.views.empty()) throw ToolError(name + ": no pairs in it");
  return survey;
}

}  // namespace roomcal::tools
