#include "tools/evaluate/paper_rendered.h"

#include <algorithm>
#include <initializer_list>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/image_io.h"
#include "tools/common/progress.h"
#include "tools/evaluate/paper_figures.h"
#include "tools/evaluate/paper_trial.h"
#include "tools/evaluate/spread.h"
#include "tools/simulate/room_view.h"

namespace roomcal::tools {

namespace {

/// Shots of one device, from pictures and from rings of the same stands.
struct DeviceShots {
  int shots = 0, accepted = 0, observed_accepted = 0, wrong = 0;
  std::vector<double> camera_m, lidar_m;                    ///< errors of all pairs of cameras; of those with a LiDAR
  std::vector<double> observed_camera_m, observed_lidar_m;  ///< of the same shots from rings
  std::vector<double> s_per_camera, s_per_lidar, s_total;
};

bool has_lidar(const PairError& pair) { return pair.to.starts_with("lidar") || pair.from.starts_with("lidar"); }

void add_errors(const PaperTrial& trial, std::vector<double>& camera_m, std::vector<double>& lidar_m) {
  for (const PairError& pair : trial.pairs) (has_lidar(pair) ? lidar_m : camera_m).push_back(pair.position_m);
}

double seconds(const calib::Outcome& outcome, std::initializer_list<calib::Stage> stages) {
  int64_t ns = 0;
  for (const calib::Stage stage : stages) ns += outcome.stage_ns[static_cast<std::size_t>(stage)];
  return 1e-9 * static_cast<double>(ns);
}

void add_times(const calib::Outcome& outcome, DeviceShots& shots) {
  using calib::Stage;
  shots.s_per_camera.push_back(seconds(outcome, {Stage::kDetect, Stage::kLocate}) /
                               static_cast<double>(outcome.cameras.size()));
  if (!outcome.lidars.empty())
    shots.s_per_lidar.push_back(seconds(outcome, {Stage::kLocateLidars}) / static_cast<double>(outcome.lidars.size()));
  shots.s_total.push_back(
      seconds(outcome, {Stage::kDetect, Stage::kLocate, Stage::kLocateLidars, Stage::kRefine, Stage::kJudge}));
}

void run_shot(const TrustRoom& room, const LitScene& lit, const std::string& device, uint64_t seed,
              DeviceShots& shots) {
  const PaperStand stand = stand_in(room, device, seed);
  std::vector<cv::Mat> images;
  for (const TrueCamera& camera : stand.stand.cameras)
    images.push_back(take_picture(lit, camera, stand.options, 100 * seed + images.size()).image);
  std::vector<ImageView> views;
  for (const cv::Mat& image : images) views.push_back(view(image));
  const std::vector<std::vector<LoadedSweep>> taken = take_sweeps(room, stand, seed);
  const SweepsView sweeps(taken);
  TrustSession session(stand.device, room.data());
  require(session.calibrate(calib::Shot{views, sweeps.sweeps()}), "simulated pictures");
  add_times(session.outcome(), shots);
  const PaperTrial trial = judge_outcome(session.outcome(), stand);
  const PaperTrial observed = run_paper_trial(room, room.data(), 0, device, seed);
  ++shots.shots;
  shots.accepted += trial.accepted() ? 1 : 0;
  shots.observed_accepted += observed.accepted() ? 1 : 0;
  shots.wrong += trial.wrong() ? 1 : 0;
  add_errors(trial, shots.camera_m, shots.lidar_m);
  add_errors(observed, shots.observed_camera_m, shots.observed_lidar_m);
}

double best(const std::vector<double>& times) {
  return times.empty() ? 0 : *std::min_element(times.begin(), times.end());
}

std::string mean_mm(const std::vector<double>& errors_m) {
  return errors_m.empty() ? "-" : figure(spread_of(errors_m, 1e3).mean);
}

std::string pixels(const camera::Intrinsics& lens) { return fmt::format("{} x {}", lens.width_px, lens.height_px); }

void add_row(const PaperDevice& device, const DeviceShots& shots, PaperTable& table) {
  const bool lidars = !device.lidars.empty();
  table.rows.push_back({device.name, pixels(device.cameras[0].nominal),
                        fmt::format("{} of {}", shots.accepted, shots.shots),
                        fmt::format("{} of {}", shots.observed_accepted, shots.shots), mean_mm(shots.camera_m),
                        mean_mm(shots.observed_camera_m), mean_mm(shots.lidar_m), mean_mm(shots.observed_lidar_m),
                        figure(kPaperCamera_s), figure(best(shots.s_per_camera)), lidars ? figure(kPaperLidar_s) : "-",
                        lidars ? figure(best(shots.s_per_lidar)) : "-", figure(best(shots.s_total))});
  table.wrong += shots.wrong;
  if (best(shots.s_per_camera) >= kPaperCamera_s) table.worse.push_back(device.name + ": time of a camera");
  if (best(shots.s_per_lidar) >= kPaperLidar_s) table.worse.push_back(device.name + ": time of a LiDAR");
}

}  // namespace

PaperTable rendered_table(const TrustRoom& room, int shots) {
  PaperTable table;
  table.title = "Through pictures and packets, and how long it takes";
  table.text =
      "The same stands twice: rendered pictures at full resolution through the detector, and rings with noise. Mean "
      "position error over all pairs of cameras and over all pairs with a LiDAR. Times: best shot, one thread, this "
      "machine; a camera is its detection and location, a LiDAR the location of its decoded sweep. Paper: i7-8700K, "
      "manual work not counted.";
  table.rows.push_back({"device", "cameras px", "accepted", "from rings", "cameras mm", "from rings", "LiDARs mm",
                        "from rings", "paper s a camera", "ours s", "paper s a LiDAR", "ours s", "ours s, whole shot"});
  const LitScene lit(room.scene());
  Progress progress("pictures", known_devices().size() * static_cast<std::size_t>(shots));
  for (const PaperDevice& device : known_devices()) {
    DeviceShots done;
    for (int i = 0; i < shots; ++i, progress.step())
      run_shot(room, lit, device.name, static_cast<uint64_t>(i) + 1, done);
    add_row(device, done, table);
  }
  return table;
}

}  // namespace roomcal::tools
