#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/truth/synthetic_room.h"
#include "tools/bake/survey.h"

namespace roomcal::tools::test {

/// A stereo pair walked through the paper's room, with its truth.
struct SyntheticSurvey {
  std::vector<truth::RoomMarker> room;
  StereoRig rig;
  Survey survey;
  std::vector<SE3> T_room_left;
};

inline StereoRig make_stereo_rig() {
  const camera::Camera camera = truth::make_camera(truth::LensKind::kNarrow);
  return {{camera, camera}, {so3_exp({0.004, -0.015, 0.003}), Vec3(-0.12, 0.0005, -0.002)}};
}

/// Camera at `position`, looking along `heading_rad` (about z) and `pitch_rad` down.
inline SE3 look(const Vec3& position, double heading_rad, double pitch_rad) {
  Mat33 R_walk_cam;  // walk frame: x forward, y left, z up
  R_walk_cam << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {so3_exp({0, 0, heading_rad}) * so3_exp({0, pitch_rad, 0}) * R_walk_cam, position};
}

inline void add_view(SyntheticSurvey& s, const SE3& T_room_left, double sigma_px, truth::Random& random) {
  StereoView view;
  view.name = std::to_string(s.survey.views.size());
  for (const Side side : kBothSides) {
    const SE3 T_room_cam = side == kLeft ? T_room_left : T_room_left * s.rig.T_right_left.inverse();
    for (const truth::Sighting& seen : truth::see_markers(s.room, s.rig.cameras[side], T_room_cam)) {
      view.seen[side].push_back({seen.centre_px + sigma_px * random.normals<2>(), Mat22::Identity(), {}});
    }
  }
  std::reverse(view.seen[kRight].begin(), view.seen[kRight].end());
  s.survey.views.push_back(std::move(view));
  s.T_room_left.push_back(T_room_left);
}

/// One turn on the spot's circle for each pitch, `steps` views a turn, through a room.
inline SyntheticSurvey walk_through(const std::vector<truth::RoomMarker>& room, uint64_t seed, double sigma_px,
                                    int steps) {
  truth::Random random(seed);
  SyntheticSurvey s{room, make_stereo_rig(), {}, {}};
  s.survey.source = "synthetic";
  for (const double pitch_rad : {0.1, 0.35, 0.6}) {
    for (int i = 0; i < steps; ++i) {
      const double heading_rad = 2 * kPi * i / steps;
      const Vec3 back(-0.8 * std::cos(heading_rad), -0.8 * std::sin(heading_rad), 0);
      add_view(s, look(Vec3(1.5, 2.0, 1.4) + back, heading_rad, pitch_rad), sigma_px, random);
    }
  }
  return s;
}

/// A room of half the usual markers: a quarter of the time, which the sanitizers multiply.
inline SyntheticSurvey make_survey(uint64_t seed, double sigma_px, int steps = 18) {
  truth::Random random(seed);
  return walk_through(truth::make_room(random, 180), seed, sigma_px, steps);
}

}  // namespace roomcal::tools::test
