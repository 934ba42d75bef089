#include "tools/bake/bake.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "tools/bake/map_covariance.h"
#include "tools/bake/marker_shape.h"
#include "tools/map/complete_map.h"
#include "tools/map/plane_fit.h"

namespace roomcal::tools {

namespace {

class Baker {
 public:
  Baker(const Survey& survey, const StereoRig& rig, const BakeOptions& options)
      : survey_(survey), rig_(rig), options_(options) {}

  BakeResult run() {
    result_.map = reconstruct(survey_, rig_, options_.reconstruct, result_.summary);
    number_points();
    find_covariances();
    find_shapes();
    settle_scale();
    make_markers();
    settle_axes();
    complete_map(result_.data);
    result_.quality = measure_quality(survey_, result_.map, covariances_, bundle_options());
    summarize_residuals();
    result_.map_quality = measure_map_quality(result_.data);
    advise_survey();
    return std::move(result_);
  }

 private:
  /// Ids count the points as the survey met them.
  void number_points() {
    ids_.assign(result_.map.points.size(), 0);
    uint32_t next = 0;
    for (std::size_t p = 0; p < ids_.size(); ++p) {
      if (result_.map.alive[p]) ids_[p] = next++;
    }
  }

  BundleOptions bundle_options() const {
    BundleOptions bundle;
    bundle.sigma_px = result_.summary.sigma_px;
    bundle.refine_rig = result_.summary.refined;
    bundle.given_rig = rig_;
    bundle.prior = options_.reconstruct.prior;
    return bundle;
  }

  void find_covariances() {
    // Scale apart: it is one number for all markers, stated in the report; in each marker's own covariance it would be
    // taken for as many independent errors.
    constexpr double kExact = 1e-6;
    BundleOptions bundle = bundle_options();
    bundle.prior.baseline = kExact;
    covariances_ = map_covariance(survey_, result_.map, bundle);
  }

  /// Shapes start from the wall that the marker is on, where there is one.
  void find_shapes() {
    const auto sights = collect_sights(result_.map);
    std::vector<map::MapMarker> bare;
    std::vector<std::size_t> point;
    for (std::size_t p = 0; p < ids_.size(); ++p) {
      if (!result_.map.alive[p]) continue;
      bare.emplace_back().p_room = result_.map.points[p].p;
      point.push_back(p);
    }
    const std::vector<PlaneData> planes = fit_planes(bare);
    shapes_.assign(ids_.size(), std::nullopt);
    for (std::size_t i = 0; i < bare.size(); ++i) {
      const SE3& first = result_.map.views[sights[point[i]].front().view].T_room_left;
      const Vec3 normal = bare[i].plane >= 0 ? planes[static_cast<std::size_t>(bare[i].plane)].plane.normal_room
                                             : Vec3(first.t - bare[i].p_room);
      shapes_[point[i]] = fit_shape(survey_, result_.map, sights[point[i]], bare[i].p_room, normal);
    }
  }

  void settle_scale() {
    std::vector<MeasuredDistance> distances;
    if (!options_.distances.empty()) distances = read_distances(options_.distances, survey_, result_.map, ids_);
    ScaleOptions scale;
    scale.marker_radius_m = options_.marker_radius_m;
    if (result_.summary.refined) {
      scale.baseline_sigma = options_.reconstruct.prior.baseline;
      scale.scale_as_given = result_.summary.scale_as_given;
    }
    result_.scale = judge_scale(result_.map, distances, shapes_, scale);
    fmt::print("scale    {}\n", result_.scale.message);
    const double s = result_.scale.factor;
    for (SpacePoint& point : result_.map.points) point = {s * point.p, s * s * point.cov_m2};
    for (ViewState& view : result_.map.views) view.T_room_left.t *= s;
    result_.map.rig.T_right_left.t *= s;
    for (Mat33& cov_m2 : covariances_) cov_m2 *= s * s;
    for (auto& shape : shapes_) {
      if (!shape) continue;
      shape->radius_m *= s;
      shape->sigma_radius_m *= s;
    }
  }

  void make_markers() {
    constexpr double kUsefulNormal_rad = deg_to_rad(5);
    for (std::size_t p = 0; p < ids_.size(); ++p) {
      if (!result_.map.alive[p]) continue;
      map::MapMarker marker;
      marker.id = ids_[p];
      marker.p_room = result_.map.points[p].p;
      marker.cov_m2 = covariances_[p];
      if (const auto& shape = shapes_[p]; shape && shape->sigma_normal_rad < kUsefulNormal_rad) {
        marker.normal_room = shape->normal_room;
        marker.has_normal = true;
        marker.radius_m = shape->radius_m;
        marker.has_radius = true;
      }
      result_.data.markers.push_back(marker);
    }
  }

  void settle_axes() {
    const std::vector<PlaneData> planes = fit_planes(result_.data.markers);
    Vec3 up = Vec3::Zero();
    for (const std::size_t v : result_.map.order) up -= result_.map.views[v].T_room_left.R.col(1);
    const Vec3 start = result_.map.views[result_.map.order.front()].T_room_left.t;
    result_.axes = find_axes(result_.data.markers, planes, start, up.normalized());
    const SE3& T_room_survey = result_.axes.T_room_survey;
    fmt::print("axes     {}\n", result_.axes.description);
    const Mat33& R = T_room_survey.R;
    for (map::MapMarker& marker : result_.data.markers) {
      marker.p_room = T_room_survey * marker.p_room;
      marker.cov_m2 = R * marker.cov_m2 * R.transpose();
      marker.normal_room = R * marker.normal_room;
    }
    for (SpacePoint& point : result_.map.points) point = {T_room_survey * point.p, R * point.cov_m2 * R.transpose()};
    for (ViewState& view : result_.map.views) view.T_room_left = T_room_survey * view.T_room_left;
  }

  void summarize_residuals() {
    for (const Side side : kBothSides) {
      std::vector<double> lengths_px = residual_lengths(survey_, result_.map, side);
      if (lengths_px.empty()) continue;
      std::sort(lengths_px.begin(), lengths_px.end());
      result_.median_px[side] = lengths_px[lengths_px.size() / 2];
      const double sum = std::inner_product(lengths_px.begin(), lengths_px.end(), lengths_px.begin(), 0.0);
      result_.rms_px[side] = std::sqrt(sum / static_cast<double>(lengths_px.size()));
    }
  }

  /// Markers that hang by few stops: what the survey itself can mend.
  void advise_survey() {
    constexpr std::size_t kFewViews = 4;
    std::string ids;
    std::size_t count = 0;
    for (std::size_t i = 0; i < result_.quality.size(); ++i) {
      if (result_.quality[i].views >= kFewViews) continue;
      constexpr std::size_t kNamed = 8;
      if (count++ < kNamed) ids += fmt::format("{}{}", ids.empty() ? "" : ", ", result_.data.markers[i].id);
    }
    if (count == 0) return;
    auto& advice = result_.map_quality.advice;
    advice.insert(advice.begin(), fmt::format("walk there again: {} markers were measured from fewer than {} stops "
                                              "(ids {}{})",
                                              count, kFewViews, ids, count > 8 ? " ..." : ""));
  }

  const Survey& survey_;
  const StereoRig& rig_;
  const BakeOptions& options_;
  BakeResult result_;
  std::vector<uint32_t> ids_;  ///< by point number
  std::vector<Mat33> covariances_;
  std::vector<std::optional<MarkerShape>> shapes_;
};

}  // namespace

BakeResult bake(const Survey& survey, const StereoRig& rig, const BakeOptions& options) {
  Survey weighed = survey;
  normalize_covariances(weighed);
  return Baker(weighed, rig, options).run();
}

}  // namespace roomcal::tools
