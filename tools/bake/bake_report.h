#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/bake/bake.h"

namespace roomcal::tools {

/// What `roomcal bake --json` writes: survey {pairs, placed, without_markers, lost, remarks}, markers (count),
/// reprojection {median_px, rms_px: left, right}, sigma_px, loops, scale, stereo {given, used}, axes, planes, lines,
/// corners, and per marker expected and held-out error, views, sightings.
nlohmann::ordered_json bake_json(const Survey& survey, const StereoRig& given, const BakeResult& result);

/// The same for people.
std::string bake_text(const Survey& survey, const StereoRig& given, const BakeResult& result);

}  // namespace roomcal::tools
