#include "tools/evaluate/paper_maps.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "tools/bake/bake.h"
#include "tools/common/error.h"
#include "tools/common/progress.h"
#include "tools/evaluate/paper_figures.h"
#include "tools/evaluate/paper_trial.h"
#include "tools/map/compare.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/raster.h"

namespace roomcal::tools {

namespace {

/// A walk in a circle through the middle of the room, looking across it and slowly from the ceiling to the floor.
struct Walk {
  const char* name;
  double first_rad, turns, radius_m, height_m;  ///< turns below 0: the other way around
};
constexpr Walk kWalks[] = {{"first", 0.3, 6, 0.6, 1.3}, {"second", 2.1, -5, 0.75, 1.55}};
constexpr double kPitchUp_rad = -0.45, kPitchDown_rad = 1.1;

/// How well the survey measures.
struct Quality {
  const char* name;
  double sigma_px;
  bool calibration_off;
};
constexpr Quality kQualities[] = {{"rings as rendered ones, calibration true", 0.03, false},
                                  {"rings as in the paper's room, calibration off", 0.16, true}};
// What Kalibr leaves of a pair from 45 pictures that fit to 0.13 px [P]: lenses can then only be off together, by about
// a pixel of 1746, and the pair turned by a fifth of a pixel.
constexpr double kBaselineSigma = 0.001, kPairSigma_rad = 0.0001, kFocalSigma = 0.0005, kLensSigma_px = 0.2;

SE3 look(const Vec3& from, double heading_rad, double pitch_rad) {
  Mat33 R_walk_cam;  // walk: x forward, y left, z up
  R_walk_cam << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {so3_exp({0, 0, heading_rad}) * so3_exp({0, pitch_rad, 0}) * R_walk_cam, from};
}

SE3 place_at(const Walk& walk, const Vec3& room_size, double share) {
  const double heading = walk.first_rad + 2 * kPi * walk.turns * share;
  const Vec3 back(walk.radius_m * std::cos(heading), walk.radius_m * std::sin(heading), 0);
  const Vec3 middle(room_size.x() / 2, room_size.y() / 2, walk.height_m);
  return look(middle - back, heading, std::lerp(kPitchUp_rad, kPitchDown_rad, share));
}

StereoRig true_rig(const TrustRoom& room) {
  const PaperStand stand = stand_in(room, "stereo_rig", 1);
  const std::vector<TrueCamera>& cameras = stand.stand.cameras;
  return {{cameras[0].camera, cameras[1].camera}, cameras[1].T_room_cam.inverse() * cameras[0].T_room_cam};
}

/// The pair as a calibration of its own left it.
StereoRig given_rig(StereoRig rig, Random& random) {
  const uint64_t lens_seed = random.bits();
  for (camera::Camera& camera : rig.cameras) {
    const camera::IntrinsicsSigma sigma{kFocalSigma * camera.intrinsics().fx_px, kLensSigma_px, kLensSigma_px};
    Random same_for_both(lens_seed);
    camera = given_lens(camera, sigma, same_for_both);
  }
  rig.T_right_left.t *= 1 + kBaselineSigma * random.normal();
  const Vec3 turn{random.normal(), random.normal(), random.normal()};
  rig.T_right_left.R = so3_exp(kPairSigma_rad * turn) * rig.T_right_left.R;
  return rig;
}

Survey walk_through(const TrustRoom& room, const StereoRig& rig, const Walk& walk, double sigma_px, int pairs,
                    uint64_t seed) {
  Survey survey;
  survey.source = "simulated";
  survey.views.resize(static_cast<std::size_t>(pairs));
  parallel_for(pairs, [&](int i) {
    Random random = random_stream(seed, static_cast<uint64_t>(i));
    StereoView& view = survey.views[static_cast<std::size_t>(i)];
    view.name = fmt::format("{:06}", i);
    const SE3 T_room_left = place_at(walk, room.scene().size, static_cast<double>(i) / pairs);
    for (const Side side : kBothSides) {
      const SE3 T_room_cam = side == kLeft ? T_room_left : T_room_left * rig.T_right_left.inverse();
      for (const marker::Detection& ring : see_rings(room, rig.cameras[side], T_room_cam, random, sigma_px))
        view.seen[side].push_back({ring.centre_px, ring.cov_px2, {}});
    }
  });
  return survey;
}

double planes_rms_m(const MapData& map) {
  double squares = 0;
  for (const PlaneData& plane : map.planes) squares += plane.plane.rms_m * plane.plane.rms_m;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, map.planes.size())));
}

double worst_offset_m(const MapComparison& comparison) {
  double worst_m = 0;
  for (const PlaneDifference& plane : comparison.planes) worst_m = std::max(worst_m, std::abs(plane.offset_m));
  return worst_m;
}

void add_map(const TrustRoom& room, std::size_t walk, const Quality& quality, int pairs, PaperTable& table) {
  const uint64_t seed = 10 * (walk + 1) + (quality.calibration_off ? 1 : 0);
  Random random = random_stream(seed, 1U << 20);
  const StereoRig rig = true_rig(room);
  const Survey survey = walk_through(room, rig, kWalks[walk], quality.sigma_px, pairs, seed);
  const BakeResult baked = bake(survey, quality.calibration_off ? given_rig(rig, random) : rig, {});
  const auto comparison = compare_maps(room.data(), baked.data);
  if (!comparison) throw ToolError("simulated survey: its map does not lie over the room");
  const double paper_mm = 1e3 * kPaperMapError_m[walk], ours_mm = 1e3 * comparison->mean_m;
  table.rows.push_back({kWalks[walk].name, quality.name, fmt::format("{}", pairs),
                        fmt::format("{} of {}", comparison->matched.size(), room.data().markers.size()),
                        figure(paper_mm), figure(ours_mm), figure(1e3 * comparison->rms_m),
                        figure(1e3 * comparison->max_m), figure(1e3 * kPaperPlaneError_m),
                        figure(1e3 * planes_rms_m(baked.data)), figure(1e3 * worst_offset_m(*comparison)),
                        times_smaller(paper_mm, ours_mm)});
  if (ours_mm >= paper_mm)
    table.worse.push_back(fmt::format("{} survey, {}: {} mm (paper {})", kWalks[walk].name, quality.name,
                                      figure(ours_mm), figure(paper_mm)));
}

/// A survey that cannot become a map is a row too.
void try_map(const TrustRoom& room, std::size_t walk, const Quality& quality, int pairs, PaperTable& table) {
  try {
    add_map(room, walk, quality, pairs, table);
  } catch (const ToolError& error) {
    std::vector<std::string> row = {kWalks[walk].name, quality.name, fmt::format("{}", pairs), "no map"};
    row.resize(table.rows[0].size(), "-");
    table.rows.push_back(row);
    table.worse.push_back(fmt::format("{} survey, {}: {}", kWalks[walk].name, quality.name, error.what()));
  }
}

}  // namespace

PaperTable maps_table(const TrustRoom& room, int pairs) {
  PaperTable table;
  table.title = "Map of the room from two surveys";
  table.text =
      "Room of 3 x 4 x 2.7 m with 340 sheets, walked through with the stereo rig; centres of rings with noise, no "
      "identities, no order. Rings as in the paper's room: 0.16 px per axis, what its own key points leave; "
      "calibration off: both focal lengths by one draw of 0.05 %, principal points and distortion of 0.2 px, the "
      "baseline of 0.1 %, the pair turned by 0.1 mrad. Mean distance of the markers from the truth after rigid "
      "alignment; the paper's is against a laser scanner.";
  table.rows.push_back({"survey", "quality", "pairs", "markers", "paper mean mm", "ours mean mm", "RMS", "worst",
                        "paper planes mm", "our planes mm", "worst wall off mm", "mean"});
  Progress progress("maps", std::size(kQualities) * std::size(kWalks));
  for (const Quality& quality : kQualities)
    for (std::size_t walk = 0; walk < std::size(kWalks); ++walk, progress.step())
      try_map(room, walk, quality, pairs, table);
  return table;
}

}  // namespace roomcal::tools
