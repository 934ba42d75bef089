#include "tools/evaluate/paper_markers.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/core.h>

#include "runtime/marker/detector.h"
#include "runtime/rig/camera_rig.h"
#include "tools/common/error.h"
#include "tools/common/image_io.h"
#include "tools/common/progress.h"
#include "tools/evaluate/paper_figures.h"
#include "tools/evaluate/paper_trial.h"
#include "tools/evaluate/spread.h"
#include "tools/evaluate/tag_view.h"

namespace roomcal::tools {

namespace {

constexpr double kTagSigma_px = 0.1;  // of a corner; the solver widens it to what a picture shows
constexpr double kSame_px = 3;        // a ring is the marker whose true centre lies nearest

/// What one kind of marker came to.
struct KindTally {
  int visible = 0, found = 0;            ///< markers, all pictures
  std::vector<double> point_px, fit_px;  ///< of every point: distance to the truth; of every picture: reprojection
  std::vector<double> baseline_m;        ///< found less true
  std::vector<double> detect_ms;         ///< a picture
};

/// What one camera saw of its landmarks.
struct Seen {
  std::vector<rig::RingObservation> observations;
};

/// Finds markers of one kind in a picture of one camera.
class Kind {
 public:
  virtual ~Kind() = default;
  virtual const std::vector<rig::Landmark>& landmarks() const = 0;
  virtual cv::Mat take(const TrueCamera& camera, const ShotOptions& options, uint64_t seed) const = 0;
  /// @return markers found.
  virtual int find(const cv::Mat& image, const TrueCamera& camera, Seen& seen) = 0;
};

class Rings final : public Kind {
 public:
  explicit Rings(const Scene& scene) : lit_(scene) {
    for (const SceneMarker& marker : markers_of(scene)) landmarks_.push_back({marker.centre_room, Mat33::Zero()});
  }
  const std::vector<rig::Landmark>& landmarks() const override { return landmarks_; }
  cv::Mat take(const TrueCamera& camera, const ShotOptions& options, uint64_t seed) const override {
    return take_picture(lit_, camera, options, seed).image;
  }
  int find(const cv::Mat& image, const TrueCamera& camera, Seen& seen) override {
    memory_.resize(marker::detector_scratch_bytes(image.cols, image.rows));
    Arena scratch(memory_);
    std::vector<marker::Detection> found(calib::kMaxDetections);
    std::size_t count = 0;
    require(marker::detect(view(image), {}, scratch, found, count), "simulated picture");
    for (std::size_t i = 0; i < count; ++i) {
      if (found[i].status != marker::DetectionStatus::kOk) continue;
      if (const int landmark = nearest(camera, found[i].centre_px); landmark >= 0)
        seen.observations.push_back({found[i].centre_px, found[i].cov_px2, static_cast<uint16_t>(landmark)});
    }
    return static_cast<int>(seen.observations.size());
  }

 private:
  int nearest(const TrueCamera& camera, const Vec2& centre_px) const {
    int best = -1;
    double best_px = kSame_px;
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      Vec2 px;
      if (!camera.camera.project(camera.T_room_cam.inverse() * landmarks_[i].p_room, px).ok()) continue;
      if ((px - centre_px).norm() >= best_px) continue;
      best = static_cast<int>(i);
      best_px = (px - centre_px).norm();
    }
    return best;
  }

  LitScene lit_;
  std::vector<rig::Landmark> landmarks_;
  std::vector<std::byte> memory_;
};

class Tags final : public Kind {
 public:
  explicit Tags(const Scene& scene) : rings_(scene), blank_(with_blank_sheets(scene)), lit_(blank_) {
    landmarks_.resize(kTagCorners.size() * markers_of(scene).size());
    for (const Plane& wall : scene.walls)
      for (const Decal& decal : wall.decals) {
        if (decal.print != Print::kRings) continue;
        const std::array<Vec3, 4> corners = tag_corners_room(wall, decal);
        for (std::size_t k = 0; k < corners.size(); ++k)
          landmarks_.at(corners.size() * static_cast<std::size_t>(decal.marker_id) + k).p_room = corners[k];
      }
  }
  const std::vector<rig::Landmark>& landmarks() const override { return landmarks_; }
  cv::Mat take(const TrueCamera& camera, const ShotOptions& options, uint64_t seed) const override {
    const TagView view(lit_, rings_, camera.camera, camera.T_room_cam);
    return develop(expose_view(view, view.blank().paper_radiance_quantile(kBrightPaper), camera, options), seed).image;
  }
  int find(const cv::Mat& image, const TrueCamera&, Seen& seen) override {
    int found = 0;
    for (const TagDetection& tag : find_tags(image)) {
      const std::size_t first = kTagCorners.size() * static_cast<std::size_t>(tag.id);
      if (first >= landmarks_.size()) continue;
      ++found;
      for (std::size_t k = 0; k < tag.corners_px.size(); ++k)
        seen.observations.push_back(
            {tag.corners_px[k], kTagSigma_px * kTagSigma_px * Mat22::Identity(), static_cast<uint16_t>(first + k)});
    }
    return found;
  }

 private:
  const Scene& rings_;
  Scene blank_;
  LitScene lit_;
  std::vector<rig::Landmark> landmarks_;
};

void add_point_errors(const Kind& kind, const TrueCamera& camera, const Seen& seen, KindTally& tally) {
  for (const rig::RingObservation& point : seen.observations) {
    Vec2 px;
    const Vec3& p_room = kind.landmarks()[point.landmark].p_room;
    if (camera.camera.project(camera.T_room_cam.inverse() * p_room, px).ok())
      tally.point_px.push_back((px - point.centre_px).norm());
  }
}

/// The device's own joint solution, started at the truth: markers are compared, not the search for a pose.
void solve(const Kind& kind, const std::vector<TrueCamera>& cameras, const std::vector<Seen>& seen, KindTally& tally) {
  std::vector<rig::CameraView> views;
  std::size_t points = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    rig::CameraView& view = views.emplace_back();
    view.camera = &cameras[i].camera;
    view.observations = seen[i].observations;
    view.T_room_cam = cameras[i].T_room_cam;
    points += seen[i].observations.size();
  }
  std::vector<std::byte> step_bytes(rig::solve_step_bytes(views.size()) + 1024);
  std::vector<std::byte> scratch_bytes(rig::solve_scratch_bytes(views.size(), points, kind.landmarks().size()) + 1024);
  Arena step(step_bytes), scratch(scratch_bytes);
  rig::RigSolution solution;
  if (!rig::solve_cameras(views, kind.landmarks(), {}, step, scratch, solution).ok()) return;
  const SE3 T_true = cameras[0].T_room_cam.inverse() * cameras[1].T_room_cam;
  tally.baseline_m.push_back(rig::relative_pose(solution, 0, 1).T_a_b.t.norm() - T_true.t.norm());
  for (const double rms_px : solution.rms_px) tally.fit_px.push_back(std::sqrt(2.0) * rms_px);  // rms_px: per axis
}

void run_shot(Kind& kind, const TrustRoom& room, const PaperStand& stand, uint64_t seed, KindTally& tally) {
  const std::vector<TrueCamera>& cameras = stand.stand.cameras;
  std::vector<Seen> seen(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const cv::Mat image = kind.take(cameras[i], stand.options, 100 * seed + i);
    const auto start = std::chrono::steady_clock::now();
    tally.found += kind.find(image, cameras[i], seen[i]);
    tally.detect_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    for (const MarkerTruth& truth : project_markers(room.scene(), cameras[i].camera, cameras[i].T_room_cam))
      tally.visible += truth.visible > 0.999 ? 1 : 0;
    add_point_errors(kind, cameras[i], seen[i], tally);
  }
  solve(kind, cameras, seen, tally);
}

void add_row(const std::string& name, const PaperMarkerRow& paper, const KindTally& tally, PaperTable& table) {
  const Spread mm = spread_of(tally.baseline_m, 1e3);
  const auto pictures = static_cast<double>(std::max<std::size_t>(1, tally.detect_ms.size()));
  table.rows.push_back({name, fmt::format("{}", paper.count), figure(tally.found / pictures),
                        fmt::format("{:.1f} %", 100.0 * tally.found / std::max(1, tally.visible)),
                        figure(spread_of(tally.point_px).rms), figure(paper.reprojection_px),
                        figure(spread_of(tally.fit_px).rms), figure(1e3 * paper.baseline_error_m), figure(mm.mean),
                        figure(1e3 * paper.baseline_sd_m), figure(mm.sd), figure(mm.worst),
                        figure(*std::min_element(tally.detect_ms.begin(), tally.detect_ms.end()))});
}

}  // namespace

PaperTable markers_table(const TrustRoom& room, int shots) {
  PaperTable table;
  table.title = "Rings against AprilTags on the same sheets";
  table.text = fmt::format(
      "Stereo rig at {} places, pictures of 1280 x 1024 rendered twice: rings of 170 mm, and AprilTags (36h11, their "
      "four "
      "corners) with a black square of 170 mm in their place. Correspondences given, the same joint solution from the "
      "truth, so that only the markers differ. The paper had 40 rings and 100 tags in view at 2 m.",
      shots);
  table.rows.push_back({"marker", "paper: in view", "found a picture", "of whole ones", "point off px", "paper px",
                        "our px", "paper baseline off mm", "ours, mean", "paper sd", "our sd", "our worst",
                        "detection ms"});
  Progress progress("markers", static_cast<std::size_t>(shots) * (has_tags() ? 2 : 1));
  const auto measure = [&](Kind& kind) {
    KindTally tally;
    for (int i = 0; i < shots; ++i, progress.step()) {
      const auto seed = static_cast<uint64_t>(i) + 1;
      run_shot(kind, room, stand_in(room, "stereo_rig", seed), seed, tally);
    }
    return tally;
  };
  Rings rings(room.scene());
  const KindTally of_rings = measure(rings);
  add_row("rings", kPaperRings, of_rings, table);
  const double sd_m = spread_of(of_rings.baseline_m).sd;
  if (sd_m >= kPaperRings.baseline_sd_m)
    table.worse.push_back(fmt::format("rings: baseline's sd {} mm (paper {})", figure(1e3 * sd_m),
                                      figure(1e3 * kPaperRings.baseline_sd_m)));
  if (!has_tags()) {
    table.text += " AprilTags are skipped: built without libapriltag (libapriltag-dev).";
    return table;
  }
  Tags tags(room.scene());
  add_row("AprilTags", kPaperAprilTags, measure(tags), table);
  return table;
}

}  // namespace roomcal::tools
