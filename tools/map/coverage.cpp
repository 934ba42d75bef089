#include "tools/map/coverage.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "runtime/pose/locate_camera.h"
#include "tools/common/error.h"
#include "tools/common/random.h"

namespace roomcal::tools {

namespace {

constexpr std::size_t kStepBytes = 1 << 20;

camera::Camera sample_camera(const CoverageOptions& options) {
  camera::Intrinsics k;
  k.fx_px = k.fy_px = options.focal_px;
  k.width_px = options.width_px;
  k.height_px = options.height_px;
  k.cx_px = 0.5 * (options.width_px - 1);
  k.cy_px = 0.5 * (options.height_px - 1);
  const Result<camera::Camera> camera = camera::Camera::create(k);
  require(camera.status(), "sample camera");
  return camera.value();
}

/// A grid through the box of the markers, no finer than the count allows.
std::vector<Vec3> positions_in(const MapData& data, const CoverageOptions& options) {
  Vec3 low = data.markers.front().p_room, high = low;
  for (const map::MapMarker& marker : data.markers) {
    low = low.cwiseMin(marker.p_room);
    high = high.cwiseMax(marker.p_room);
  }
  const auto count_at = [&](double step_m, int axis) {
    return 1 + static_cast<int>(std::max(0.0, high[axis] - low[axis] - 2 * options.from_wall_m) / step_m);
  };
  double step_m = 0.5;
  while (static_cast<std::size_t>(count_at(step_m, 0) * count_at(step_m, 1)) > options.max_positions / 2) step_m *= 1.1;
  const auto at = [&](int i, int axis) {
    const double middle = 0.5 * (low[axis] + high[axis]);
    return middle + step_m * (i - 0.5 * (count_at(step_m, axis) - 1));
  };
  std::vector<Vec3> positions;
  for (const double height : {0.25, 0.55}) {
    for (int x = 0; x < count_at(step_m, 0); ++x) {
      for (int y = 0; y < count_at(step_m, 1); ++y)
        positions.emplace_back(at(x, 0), at(y, 1), low.z() + height * (high.z() - low.z()));
    }
  }
  return positions;
}

/// Level, and tilted down by 10 degrees, like a camera on a robot.
SE3 looking(const Vec3& position_room, double heading_rad) {
  Mat33 R_level_cam;  // x forward, y left, z up
  R_level_cam << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {so3_exp({0, 0, heading_rad}) * so3_exp({0, deg_to_rad(10), 0}) * R_level_cam, position_room};
}

bool crosses(const PlaneData& plane, const Vec3& from, const Vec3& to) {
  if (plane.outline_room.size() < 3) return false;
  const Vec3& n = plane.plane.normal_room;
  const double h_from = n.dot(from) + plane.plane.d_m, h_to = n.dot(to) + plane.plane.d_m;
  constexpr double kOn_m = 0.02;  // the marker's own plane does not hide it
  if (h_from * h_to >= 0 || std::abs(h_to) < kOn_m || std::abs(h_from) < kOn_m) return false;
  const Vec3 hit = from + (to - from) * (h_from / (h_from - h_to));
  for (std::size_t i = 0; i < plane.outline_room.size(); ++i) {
    const Vec3 &a = plane.outline_room[i], &b = plane.outline_room[(i + 1) % plane.outline_room.size()];
    if ((b - a).cross(hit - a).dot(n) < 0) return false;
  }
  return true;
}

class CoverageMeter {
 public:
  CoverageMeter(const MapData& data, const CoverageOptions& options)
      : data_(data),
        options_(options),
        camera_(sample_camera(options)),
        permanent_bytes_(map::TriangleIndex::bytes(data.markers.size(), data.triangles.size())),
        step_bytes_(kStepBytes),
        scratch_bytes_(pose::locate_scratch_bytes(data.markers.size())) {
    Arena permanent(permanent_bytes_);
    const Result<map::TriangleIndex> index = map::TriangleIndex::build(data.markers, data.triangles, permanent);
    require(index.status(), "triangle index");
    index_ = index.value();
  }

  SampleView look(const SE3& T_room_cam) {
    SampleView view;
    view.T_room_cam = T_room_cam;
    const std::vector<pose::Observation> seen = observe(T_room_cam);
    view.markers = seen.size();
    Arena step(step_bytes_), scratch(scratch_bytes_);
    pose::LocateOptions locate;
    locate.min_log_likelihood_gap = options_.enough_gap;
    pose::CameraLocation location;
    if (!pose::locate_camera(camera_, seen, index_, locate, step, scratch, location).ok()) return view;
    constexpr double kSame_m = 0.1;
    view.located = (location.T_room_cam.t - T_room_cam.t).norm() < kSame_m;
    view.sigma_m = std::sqrt(location.cov.topLeftCorner<3, 3>().trace());
    view.sigma_rad = std::sqrt(location.cov.bottomRightCorner<3, 3>().trace());
    // Without a second, the locator has no number; all that its evidence stands on is what is left.
    view.gap = location.has_second ? location.log_likelihood_gap : location.log_odds;
    return view;
  }

 private:
  std::vector<pose::Observation> observe(const SE3& T_room_cam) {
    std::vector<pose::Observation> seen;
    const SE3 T_cam_room = T_room_cam.inverse();
    for (const map::MapMarker& marker : data_.markers) {
      Vec2 px;
      if (!is_visible(marker, T_room_cam.t) || !camera_.project(T_cam_room * marker.p_room, px).ok()) continue;
      const double margin_px = 2 + options_.focal_px * marker.radius_m / (marker.p_room - T_room_cam.t).norm();
      if (px.minCoeff() < margin_px || px.x() > options_.width_px - 1 - margin_px ||
          px.y() > options_.height_px - 1 - margin_px) {
        continue;
      }
      pose::Observation observation;
      observation.centre_px = px + options_.sigma_px * Vec2(random_.normal(), random_.normal());
      observation.cov_px2 = options_.sigma_px * options_.sigma_px * Mat22::Identity();
      seen.push_back(observation);
    }
    return seen;
  }

  bool is_visible(const map::MapMarker& marker, const Vec3& camera_room) const {
    const Vec3 to_camera = camera_room - marker.p_room;
    const double range_m = to_camera.norm();
    if (range_m > options_.max_range_m || range_m < 0.2) return false;
    if (marker.has_normal && marker.normal_room.dot(to_camera) < std::cos(options_.max_slant_rad) * range_m)
      return false;
    return std::none_of(data_.planes.begin(), data_.planes.end(),
                        [&](const PlaneData& plane) { return crosses(plane, camera_room, marker.p_room); });
  }

  const MapData& data_;
  const CoverageOptions& options_;
  camera::Camera camera_;
  std::vector<std::byte> permanent_bytes_, step_bytes_, scratch_bytes_;
  map::TriangleIndex index_;
  Random random_{options_.seed};
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void summarize(const CoverageOptions& options, Coverage& coverage) {
  std::vector<double> sigmas_m, sigmas_rad, gaps;
  std::size_t enough = 0;
  for (const SampleView& view : coverage.views) {
    enough += view.markers >= options.enough_markers;
    if (!view.located) continue;
    sigmas_m.push_back(view.sigma_m);
    sigmas_rad.push_back(view.sigma_rad);
    gaps.push_back(view.gap);
  }
  if (coverage.views.empty()) return;
  const auto all = static_cast<double>(coverage.views.size());
  coverage.seen_share = static_cast<double>(enough) / all;
  coverage.located_share = static_cast<double>(gaps.size()) / all;
  coverage.median_sigma_m = median(sigmas_m);
  coverage.median_sigma_rad = median(sigmas_rad);
  coverage.median_gap = median(gaps);
  if (!gaps.empty()) coverage.least_gap = *std::min_element(gaps.begin(), gaps.end());
}

}  // namespace

Coverage measure_coverage(const MapData& data, const CoverageOptions& options) {
  constexpr int kHeadings = 6;
  Coverage coverage;
  if (data.markers.empty() || data.triangles.empty()) return coverage;
  CoverageMeter meter(data, options);
  for (const Vec3& position : positions_in(data, options)) {
    for (int h = 0; h < kHeadings; ++h)
      coverage.views.push_back(meter.look(looking(position, 2 * kPi * h / kHeadings)));
  }
  summarize(options, coverage);
  return coverage;
}

}  // namespace roomcal::tools
