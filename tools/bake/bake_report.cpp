#include "tools/bake/bake_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/bake/survey_checks.h"

namespace roomcal::tools {

using nlohmann::ordered_json;

namespace {

ordered_json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

ordered_json view_names(const Survey& survey, const std::vector<std::size_t>& views) {
  ordered_json names = ordered_json::array();
  for (const std::size_t v : views) names.push_back(survey.views[v].name);
  return names;
}

ordered_json rig_json(const StereoRig& rig) {
  ordered_json cameras = ordered_json::array();
  for (const Side side : kBothSides) {
    const camera::Intrinsics& k = rig.cameras[side].intrinsics();
    cameras.push_back({{"intrinsics_px", {k.fx_px, k.fy_px, k.cx_px, k.cy_px}}, {"distortion", k.distortion}});
  }
  ordered_json T = ordered_json::array();
  const Mat44 M = rig.T_right_left.matrix();
  for (int row = 0; row < 4; ++row) T.push_back({M(row, 0), M(row, 1), M(row, 2), M(row, 3)});
  return {{"baseline_mm", 1e3 * rig.baseline_m()}, {"cameras", cameras}, {"T_right_left", T}};
}

ordered_json scale_json(const ScaleReport& scale) {
  ordered_json evidence = ordered_json::array();
  for (const ScaleEvidence& e : scale.evidence)
    evidence.push_back({{"source", e.source}, {"factor", e.factor}, {"sigma", e.sigma}});
  ordered_json out{{"source", scale.source}, {"factor", scale.factor}, {"sigma", scale.sigma},
                   {"off", scale.off},       {"evidence", evidence},   {"message", scale.message}};
  out["measured_marker_radius_mm"] =
      scale.marker_radius_m ? ordered_json(1e3 * *scale.marker_radius_m) : ordered_json();
  return out;
}

ordered_json planes_json(const BakeResult& result) {
  ordered_json planes = ordered_json::array();
  for (std::size_t i = 0; i < result.data.planes.size(); ++i) {
    const map::MapPlane& plane = result.data.planes[i].plane;
    const auto members = std::count_if(result.data.markers.begin(), result.data.markers.end(),
                                       [&](const map::MapMarker& m) { return m.plane == static_cast<int>(i); });
    planes.push_back({{"normal", vector_json(plane.normal_room)},
                      {"d_m", plane.d_m},
                      {"rms_mm", 1e3 * plane.rms_m},
                      {"markers", members},
                      {"floor", result.axes.has_floor && std::abs(plane.d_m) < 1e-3 && plane.normal_room.z() > 0.99}});
  }
  return planes;
}

ordered_json structure_json(const BakeResult& result) {
  ordered_json lines = ordered_json::array(), corners = ordered_json::array();
  for (const map::MapLine& l : result.data.lines) {
    lines.push_back(
        {{"planes", {l.plane_a, l.plane_b}}, {"from", vector_json(l.from_room)}, {"to", vector_json(l.to_room)}});
  }
  for (const map::MapCorner& c : result.data.corners)
    corners.push_back({{"planes", c.planes}, {"at", vector_json(c.p_room)}});
  return {{"axes", result.axes.description}, {"planes", planes_json(result)}, {"lines", lines}, {"corners", corners}};
}

ordered_json markers_json(const BakeResult& result) {
  ordered_json markers = ordered_json::array();
  for (std::size_t i = 0; i < result.data.markers.size(); ++i) {
    const map::MapMarker& m = result.data.markers[i];
    const MarkerQuality& q = result.quality[i];
    ordered_json marker{{"id", m.id},         {"at", vector_json(m.p_room)},
                        {"views", q.views},   {"sightings", q.sightings},
                        {"rms_px", q.rms_px}, {"expected_mm", 1e3 * q.expected_m}};
    marker["held_out_mm"] = q.held_out_m >= 0 ? ordered_json(1e3 * q.held_out_m) : ordered_json();
    marker["plane"] = m.plane;
    markers.push_back(marker);
  }
  return markers;
}

/// Where the left camera stood, by the order of the survey's stops.
ordered_json path_json(const Survey& survey, const Reconstruction& map) {
  ordered_json path = ordered_json::array();
  for (std::size_t v = 0; v < map.views.size(); ++v) {
    if (!map.views[v].placed) continue;
    path.push_back({{"name", survey.views[v].name}, {"at", vector_json(map.views[v].T_room_left.t)}});
  }
  return path;
}

/// Root mean square over the markers that have the figure.
template <typename Get>
double rms_mm(const std::vector<MarkerQuality>& quality, const Get& get_m) {
  double sum2 = 0, count = 0;
  for (const MarkerQuality& q : quality) {
    if (get_m(q) < 0) continue;
    sum2 += get_m(q) * get_m(q);
    ++count;
  }
  return count > 0 ? 1e3 * std::sqrt(sum2 / count) : 0;
}

double expected_mm(const BakeResult& r) {
  return rms_mm(r.quality, [](const MarkerQuality& q) { return q.expected_m; });
}
double held_out_mm(const BakeResult& r) {
  return rms_mm(r.quality, [](const MarkerQuality& q) { return q.held_out_m; });
}

}  // namespace

ordered_json bake_json(const Survey& survey, const StereoRig& given, const BakeResult& r) {
  return {{"survey",
           {{"source", survey.source},
            {"pairs", survey.views.size()},
            {"placed", r.map.order.size()},
            {"without_markers", view_names(survey, r.summary.views_without_markers)},
            {"lost", view_names(survey, r.summary.views_lost)},
            {"remarks", survey.remarks}}},
          {"markers", r.data.markers.size()},
          {"reprojection",
           {{"median_px", r.median_px},
            {"rms_px", r.rms_px},
            {"sigma_px", r.summary.sigma_px},
            {"sigma_held_px", r.summary.sigma_held_px},
            {"sightings", r.summary.bundle.residuals}}},
          {"error_mm", {{"expected_rms", expected_mm(r)}, {"held_out_rms", held_out_mm(r)}}},
          {"loops_joined", r.summary.loops_joined},
          {"merged", r.summary.merged},
          {"rounds", r.summary.rounds},
          {"gauge", "inner constraints: mean shift and turn of all markers are zero"},
          {"scale", scale_json(r.scale)},
          {"stereo", {{"refined", r.summary.refined}, {"given", rig_json(given)}, {"used", rig_json(r.map.rig)}}},
          {"structure", structure_json(r)},
          {"quality", map_quality_json(r.map_quality)},
          {"path", path_json(survey, r.map)},
          {"marker", markers_json(r)}};
}

std::string bake_text(const Survey& survey, const StereoRig& given, const BakeResult& r) {
  std::string text;
  for (const std::string& remark : survey.remarks) text += fmt::format("note: {}\n", remark);
  if (!r.summary.views_without_markers.empty()) {
    text += fmt::format("note: {} pairs without enough markers: {}\n", r.summary.views_without_markers.size(),
                        name_views(survey, r.summary.views_without_markers));
  }
  if (!r.summary.views_lost.empty()) {
    text += fmt::format("note: {} pairs fit nowhere (blurred, or of another place): {}\n", r.summary.views_lost.size(),
                        name_views(survey, r.summary.views_lost));
  }
  text += fmt::format("{} markers on {} planes, {} corners, from {} of {} pairs\n", r.data.markers.size(),
                      r.data.planes.size(), r.data.corners.size(), r.map.order.size(), survey.views.size());
  text += fmt::format("reprojection: median {:.3f} px left, {:.3f} px right; rms {:.3f}, {:.3f} px\n",
                      r.median_px[kLeft], r.median_px[kRight], r.rms_px[kLeft], r.rms_px[kRight]);
  text += fmt::format("marker error: {:.2f} mm expected, {:.2f} mm held out (rms, scale not counted)\n", expected_mm(r),
                      held_out_mm(r));
  text += fmt::format("baseline: {:.3f} mm given, {:.3f} mm used\n", 1e3 * given.baseline_m(),
                      1e3 * r.map.rig.baseline_m());
  for (const PlaneData& plane : r.data.planes)
    text += fmt::format("plane residual {:.2f} mm\n", 1e3 * plane.plane.rms_m);
  return text + map_quality_text(r.map_quality);
}

}  // namespace roomcal::tools
