// Speed of what a press of the button waits for: the detector, the locator, the whole shot of the four-camera robot.
// Times are CPU time of one thread. Beside the detector stands a plain pass over the same image in the same run, so
// that the ratio survives another machine.
#include <algorithm>
#include <ctime>
#include <memory>
#include <numeric>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/flow/armed_session.h"
#include "tests/flow/simulated_shot.h"

namespace roomcal::flow {
namespace {

const SimulatedShot& robot_shot() {
  static const SimulatedShot shot = simulate_shot("mobile_robot", 1, 1);
  return shot;
}

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

template <typename Work>
double median_cpu_ms(const Work& work) {
  std::vector<double> times;
  for (int i = 0; i < 21; ++i) {
    const double start = cpu_ms();
    work();
    times.push_back(cpu_ms() - start);
  }
  std::nth_element(times.begin(), times.begin() + 10, times.end());
  return times[10];
}

uint64_t sum_of_pixels(const cv::Mat& image) {
  uint64_t sum = 0;
  for (int y = 0; y < image.rows; ++y) {
    const uint8_t* row = image.ptr<uint8_t>(y);
    sum += std::accumulate(row, row + image.cols, uint32_t{0});
  }
  return sum;
}

const std::vector<cv::Mat>& bare_images() {
  static const std::vector<cv::Mat> images = simulate_bare_images("mobile_robot", 1, 1);
  return images;
}

/// Argument: camera of the robot; counters: what the bar is made of.
void detect_rings(benchmark::State& state) {
  const cv::Mat& image = robot_shot().images[static_cast<std::size_t>(state.range(0))];
  const cv::Mat& bare = bare_images()[static_cast<std::size_t>(state.range(0))];
  std::vector<std::byte> memory(marker::detector_scratch_bytes(image.cols, image.rows));
  std::vector<marker::Detection> found(calib::kMaxDetections);
  std::size_t count = 0;
  const auto detect = [&](const cv::Mat& picture) {
    Arena scratch(memory);
    const Status status = marker::detect(tools::view(picture), {}, scratch, found, count);
    if (!status.ok()) state.SkipWithError(status.detail());
  };
  for (auto _ : state) detect(image);
  const double megapixels = 1e-6 * image.total();
  const double bare_ms = median_cpu_ms([&] { detect(bare); });
  const double full_ms = median_cpu_ms([&] { detect(image); });
  const double pass_ms = median_cpu_ms([&] { benchmark::DoNotOptimize(sum_of_pixels(image)); });
  state.counters["markers"] = static_cast<double>(count);
  state.counters["ms_per_MP_bare"] = bare_ms / megapixels;
  state.counters["ms_per_marker"] = (full_ms - bare_ms) / static_cast<double>(std::max<std::size_t>(1, count));
  state.counters["share_of_bar"] = full_ms / (2.5 * megapixels + 0.25 * static_cast<double>(count));
  state.counters["ratio_to_plain_pass"] = full_ms / pass_ms;
}
BENCHMARK(detect_rings)->ArgName("camera")->DenseRange(0, 3)->Unit(benchmark::kMillisecond);

/// One camera against 340 map markers, with ring sizes (a device's own map) or bearings alone (the paper's released
/// map).
void locate_one_camera(benchmark::State& state) {
  const SimulatedShot& shot = robot_shot();
  const bool with_ellipses = state.range(0) != 0;
  std::vector<std::byte> permanent(
      map::TriangleIndex::bytes(shot.map.map.marker_count(), shot.map.map.triangles().size()));
  Arena permanent_arena(permanent);
  const map::TriangleIndex index = map::TriangleIndex::build(shot.map.map, permanent_arena).value();
  std::vector<std::byte> memory(marker::detector_scratch_bytes(shot.images[0].cols, shot.images[0].rows));
  Arena detector_scratch(memory);
  std::vector<marker::Detection> found(calib::kMaxDetections);
  std::size_t count = 0;
  static_cast<void>(marker::detect(tools::view(shot.images[0]), {}, detector_scratch, found, count).ok());
  std::vector<pose::Observation> observations;
  for (std::size_t i = 0; i < count && found[i].status == marker::DetectionStatus::kOk; ++i) {
    const marker::Detection& d = found[i];
    observations.push_back({d.centre_px, d.cov_px2, with_ellipses ? d.ellipse.major_px : 0,
                            with_ellipses ? d.ellipse.minor_px : 0, d.ellipse.angle_rad});
  }
  std::vector<std::byte> step_bytes(pose::locate_step_bytes(observations.size()));
  std::vector<std::byte> scratch_bytes(pose::locate_scratch_bytes(observations.size()));
  pose::CameraLocation location;
  for (auto _ : state) {
    Arena step(step_bytes), scratch(scratch_bytes);
    const Status status =
        pose::locate_camera(shot.device->cameras[0].camera, observations, index, {}, step, scratch, location);
    if (!status.ok()) state.SkipWithError(status.detail());
  }
  state.counters["observations"] = static_cast<double>(observations.size());
  state.counters["inliers"] = static_cast<double>(location.inliers.size());
  state.counters["hypotheses"] = location.hypotheses;
}
BENCHMARK(locate_one_camera)->ArgName("ring_sizes")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond);

/// Four images in, judged extrinsics out.
void calibrate_robot(benchmark::State& state) {
  const SimulatedShot& shot = robot_shot();
  ArmedSession armed(*shot.device, shot.map.map);
  const std::vector<ImageView> images = views(shot.images);
  for (auto _ : state)
    if (!armed.calibrate(images).ok() || !calib::may_write(armed.outcome().verdict)) state.SkipWithError("no PASS");
  std::size_t markers = 0;
  for (const calib::CameraOutcome& camera : armed.outcome().cameras) markers += camera.usable_detections;
  state.counters["markers"] = static_cast<double>(markers);
  state.counters["arena_peak_MiB"] = static_cast<double>(armed.arenas().peak()) / (1 << 20);
}
BENCHMARK(calibrate_robot)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace roomcal::flow
