#include "tools/evaluate/anchor_room.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "runtime/pose/locate_camera.h"
#include "tools/common/error.h"
#include "tools/common/progress.h"
#include "tools/evaluate/stereo_shot.h"
#include "tools/map/compare.h"
#include "tools/map/complete_map.h"

namespace roomcal::tools {
namespace {

constexpr double kWrong_m = 0.05;
constexpr double kWrong_rad = deg_to_rad(1.0);
constexpr std::size_t kStepBytes = 1 << 20;

MapData bare_map(const AnchorRoom& room) {
  MapData data;
  data.id = "anchor-room";
  for (std::size_t i = 0; i < room.point_room.size(); ++i) {
    map::MapMarker marker;
    marker.id = room.point_id[i];
    marker.p_room = room.point_room[i];
    data.markers.push_back(marker);
  }
  return data;
}

/// The room as the device would have it: planes, normals and triangles found by the importer's own code.
MapData make_map(const AnchorRoom& room) {
  MapData data = bare_map(room);
  complete_map(data);
  return data;
}

/// The file's key-frames as if its authors had had this map: its points replaced by the map's markers, found without
/// identities, and its poses moved along. Key points whose marker the map lacks have no point.
AnchorRoom with_map(AnchorRoom room, const MapData& given) {
  const auto comparison = compare_maps(given, bare_map(room));
  if (!comparison) throw ToolError("map " + given.id + ": not of the file's room");
  std::vector<bool> known(room.point_room.size(), false);
  for (const auto& [in_map, in_file] : comparison->matched) {
    room.point_room[in_file] = given.markers[in_map].p_room;
    known[in_file] = true;
  }
  for (AnchorFrame& frame : room.frames) {
    frame.T_room_left = comparison->T_a_b * frame.T_room_left;
    for (int& point : frame.point) {
      if (point >= 0 && !known[static_cast<std::size_t>(point)]) point = -1;
    }
  }
  return room;
}

/// One thread's memory and the read-only things that all share.
class FrameSolver {
 public:
  FrameSolver(const camera::Camera& left, const camera::Camera& right, const SE3& T_right_left,
              const map::TriangleIndex& index, const AnchorRoomOptions& options, std::size_t most_points)
      : left_(left),
        right_(right),
        T_right_left_(T_right_left),
        index_(index),
        options_(options),
        step_bytes_(kStepBytes),
        scratch_bytes_(
            std::max(pose::locate_scratch_bytes(most_points), stereo_shot_bytes(most_points, index.markers().size()))),
        step_(step_bytes_),
        scratch_(scratch_bytes_) {}

  FrameResult solve(const AnchorFrame& frame) {
    FrameResult result;
    Arena::Scope scope(step_);
    pose::CameraLocation left;
    pose::CameraLocation right;
    const SE3 T_room_right = frame.T_room_left * T_right_left_.inverse();
    result.left = locate(left_, frame.left_px, frame.T_room_left, left);
    result.right = locate(right_, frame.right_px, T_room_right, right);
    if (!result.left.located || !result.right.located) return result;
    const StereoShot shot{left_, right_, frame.left_px, frame.right_px, left, right, options_.sigma_px};
    result.solved = solve_stereo_shot(shot, index_, step_, scratch_, result);
    return result;
  }

 private:
  LocatedView locate(const camera::Camera& camera, const std::vector<Vec2>& centre_px, const SE3& T_room_truth,
                     pose::CameraLocation& location) {
    std::vector<pose::Observation> observations(centre_px.size());
    for (std::size_t i = 0; i < centre_px.size(); ++i) {
      observations[i].centre_px = centre_px[i];
      observations[i].cov_px2 = options_.sigma_px * options_.sigma_px * Mat22::Identity();
    }
    pose::LocateOptions locate;
    locate.seed = options_.seed;
    // What counts as wrong here, at four sigmas.
    locate.max_sigma_m = locate.max_map_sigma_m = kWrong_m / 4.0;
    locate.max_sigma_rad = locate.max_map_sigma_rad = kWrong_rad / 4.0;
    LocatedView view;
    const auto start = std::chrono::steady_clock::now();
    const Status status = pose::locate_camera(camera, observations, index_, locate, step_, scratch_, location);
    view.time_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    view.located = status.ok();
    view.hypotheses = location.hypotheses;
    if (!status.ok()) {
      view.failure = std::string(to_string(status.code())) + ": " + status.detail();
      return view;
    }
    view.inliers = static_cast<int>(location.inliers.size());
    view.error_m = (location.T_room_cam.t - T_room_truth.t).norm();
    view.error_rad = rotation_angle_between(location.T_room_cam.R, T_room_truth.R);
    view.wrong = view.error_m > kWrong_m || view.error_rad > kWrong_rad;
    return view;
  }

  const camera::Camera& left_;
  const camera::Camera& right_;
  const SE3& T_right_left_;
  const map::TriangleIndex& index_;
  const AnchorRoomOptions& options_;
  std::vector<std::byte> step_bytes_;
  std::vector<std::byte> scratch_bytes_;
  Arena step_;
  Arena scratch_;
};

camera::Camera make_camera(const camera::Intrinsics& intrinsics, const char* side) {
  Result<camera::Camera> camera = camera::Camera::create(intrinsics);
  require(camera.status(), std::string("fitted intrinsics of the ") + side + " camera");
  return camera.value();
}

/// Frames are handed out one by one; each result depends on its frame alone, so threads change nothing but the time.
void solve_frames(const AnchorRoom& room, const map::TriangleIndex& index, const AnchorRoomOptions& options,
                  AnchorRoomReport& report) {
  const camera::Camera left = make_camera(report.pair.left, "left");
  const camera::Camera right = make_camera(report.pair.right, "right");
  std::size_t most_points = 0;
  for (const AnchorFrame& frame : room.frames) most_points = std::max(most_points, frame.left_px.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  Progress progress("frames", room.frames.size());
  const auto work = [&] {
    FrameSolver solver(left, right, report.pair.T_right_left, index, options, most_points);
    for (std::size_t i = next++; i < room.frames.size(); i = next++) {
      report.frames[i] = solver.solve(room.frames[i]);
      const std::lock_guard<std::mutex> lock(mutex);
      progress.step();
    }
  };
  std::vector<std::thread> helpers;
  for (unsigned t = 1; t < options.threads; ++t) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
}

void count_views(const AnchorRoom& room, AnchorRoomReport& report) {
  std::vector<double> times_ms;
  for (std::size_t i = 0; i < report.frames.size(); ++i) {
    const FrameResult& frame = report.frames[i];
    if (room.frames[i].left_px.size() >= 8) ++report.frames_with_8_markers;
    report.located_left += frame.left.located ? 1 : 0;
    report.located_right += frame.right.located ? 1 : 0;
    report.wrong += (frame.left.wrong ? 1 : 0) + (frame.right.wrong ? 1 : 0);
    times_ms.push_back(frame.left.time_ms);
    times_ms.push_back(frame.right.time_ms);
  }
  std::sort(times_ms.begin(), times_ms.end());
  report.median_ms = times_ms[times_ms.size() / 2];
  report.percentile95_ms = times_ms[times_ms.size() * 95 / 100];
  report.max_ms = times_ms.back();
}

void summarize_baselines(AnchorRoomReport& report) {
  report.joint_mm = 1e3 * report.pair.T_right_left.t.norm();
  double sum = 0;
  double sum2_px2 = 0;
  std::size_t residuals = 0;
  std::size_t count = 0;
  for (const FrameResult& frame : report.frames) {
    if (!frame.solved) continue;
    sum += frame.baseline_mm;
    sum2_px2 += frame.sum2_px2;
    residuals += frame.residuals;
    ++count;
  }
  report.solved = count;
  if (count < 2) return;
  report.mean_mm = sum / static_cast<double>(count);
  double sum2 = 0;
  for (const FrameResult& frame : report.frames) {
    if (frame.solved) sum2 += (frame.baseline_mm - report.mean_mm) * (frame.baseline_mm - report.mean_mm);
  }
  report.std_mm = std::sqrt(sum2 / static_cast<double>(count - 1));
  report.rms_px = std::sqrt(sum2_px2 / static_cast<double>(residuals));
}

}  // namespace

AnchorRoomReport evaluate_anchor_room(const AnchorRoom& file, const AnchorRoomOptions& given,
                                      const MapData* given_map) {
  AnchorRoomReport report;
  const AnchorRoom room = given_map == nullptr ? file : with_map(file, *given_map);
  report.with_given_map = given_map != nullptr;
  report.pair = fit_stereo_pair(room);
  AnchorRoomOptions options = given;
  // The median length of a two-dimensional Gaussian is 1.177 sigma.
  if (options.sigma_px <= 0)
    options.sigma_px = 0.5 * (report.pair.median_left_px + report.pair.median_right_px) / 1.177;
  report.frames.resize(room.frames.size());
  MapData data = given_map == nullptr ? make_map(room) : *given_map;
  for (map::MapMarker& marker : data.markers)
    marker.cov_m2 = options.map_sigma_m * options.map_sigma_m * Mat33::Identity();
  std::vector<std::byte> bytes(map::TriangleIndex::bytes(data.markers.size(), data.triangles.size()));
  Arena permanent(bytes);
  const Result<map::TriangleIndex> index = map::TriangleIndex::build(data.markers, data.triangles, permanent);
  require(index.status(), "triangle index");
  solve_frames(room, index.value(), options, report);
  count_views(room, report);
  summarize_baselines(report);
  return report;
}

bool AnchorRoomReport::passes() const {
  const double enough = 0.995 * static_cast<double>(frames_with_8_markers);
  const bool located = static_cast<double>(located_left) >= enough && static_cast<double>(located_right) >= enough &&
                       static_cast<double>(solved) >= enough && wrong == 0;
  if (!located || std_mm <= 0) return false;
  return with_given_map ? std_mm < 0.45 : std_mm <= 0.55 && std::abs(mean_mm - joint_mm) <= 0.1;
}

}  // namespace roomcal::tools
