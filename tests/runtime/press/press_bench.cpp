#include "tests/runtime/press/press_bench.h"

#include <cstring>

#include <gtest/gtest.h>

#include "tools/evaluate/scene_map.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/shot.h"

namespace roomcal::press::test {

namespace {

constexpr std::size_t kCameras = 2, kPage = 64, kSlotBytes = 4096;
constexpr int64_t kPeriod_ns = 33'000'000;
constexpr double kScale = 0.5;

SeenRoom render() {
  const tools::Scene scene = tools::make_room({});
  const tools::PaperDevice robot = tools::scaled(tools::device_named("mobile_robot"), kScale);
  const tools::ShotOptions options;
  const tools::Stand stand = tools::place_device(scene, robot, options);
  const tools::LitScene lit(scene);
  SeenRoom room{tools::open_map(tools::map_data_of(scene)), {}, {}};
  for (std::size_t i = 0; i < kCameras; ++i) {
    const tools::TrueCamera& camera = stand.cameras[i];
    calib::CameraSpec spec;
    spec.name = std::string_view(camera.name);
    spec.camera = camera.camera;
    spec.serial = std::string_view("S-" + std::to_string(i));
    static_cast<void>(room.device.cameras.push_back(spec));
    room.images.push_back(tools::take_picture(lit, camera, options, 1 + i).image);
  }
  return room;
}

std::size_t ring_bytes() {
  std::size_t bytes = 64 * kCameras;
  for (const cv::Mat& image : seen_room().images) bytes += grab::ImageRing::bytes(image.cols, image.rows, 2);
  return bytes;
}

}  // namespace

const SeenRoom& seen_room() {
  static const SeenRoom room = render();
  return room;
}

PressBench::PressBench(int64_t max_spread_ns, ports::Thermometer* thermometer)
    : medium(store::kSlotCount * kSlotBytes, kPage),
      plan_(calib::plan_memory(seen_room().device, seen_room().map.map)),
      block_(plan_.total_bytes()),
      ring_memory_(ring_bytes()),
      store_memory_(store::plan_store_bytes(kPage)),
      arenas_(std::move(Arenas::carve(block_, plan_.permanent_bytes, plan_.scratch_bytes)).value()),
      index_(map::TriangleIndex::build(seen_room().map.map, arenas_.permanent).value()),
      store_arena_(store_memory_),
      ring_arena_(ring_memory_) {
  const SeenRoom& room = seen_room();
  for (std::size_t i = 0; i < kCameras; ++i) {
    images.push_back(room.images[i].clone());  // a matrix is a reference: a test may spoil its own
    EXPECT_TRUE(rings_[i].create(room.images[i].cols, room.images[i].rows, 2, ring_arena_).ok());
    EXPECT_TRUE(sources_.cameras.push_back({room.device.cameras[i].name, &rings_[i]}));
  }
  EXPECT_TRUE(store.open(medium, store_arena_).ok());
  arenas_.permanent.seal();
  session_.reset(new calib::Session{room.device, room.map.map, index_, {}});
  grab::GrabOptions options;
  options.patience_ns = 3'000'000'000;
  options.max_spread_ns = max_spread_ns;
  grabber_ = std::make_unique<grab::Grabber>(sources_, options, clocks);
  press_ = std::make_unique<Press>(
      Parts{*session_, *grabber_, store, arenas_, clocks, "roomcald test", "RB-1", nullptr, thermometer, "line"});
  clocks.on_sleep = [this](int64_t now_ns) { deliver(now_ns); };
}

void PressBench::deliver(int64_t now_ns) {
  if (now_ns < next_image_ns_) return;
  next_image_ns_ = now_ns + kPeriod_ns;
  if (on_images) on_images();
  for (std::size_t i = 0; i < kCameras; ++i)
    if (!images[i].empty()) publish(i);
}

// As a camera's thread does it.
void PressBench::publish(std::size_t camera) {
  const cv::Mat& image = images[camera];
  const MutableImageView place = rings_[camera].begin_write();
  if (place.empty()) return;
  for (int y = 0; y < place.height(); ++y)
    std::memcpy(place.row(y), image.ptr(y), static_cast<std::size_t>(place.width()));
  const int64_t now_ns = clocks.now_ns();
  rings_[camera].publish({}, clock_maps_[camera].to_monotonic(clocks.read(stamps), 1'000, now_ns, clocks));
}

std::string PressBench::press(Kind kind) {
  press_->begin();
  press_->run(kind);
  EXPECT_EQ(press_->now().state, State::kIdle);
  return reasons();
}

std::string PressBench::reasons() const {
  std::string text;
  for (const Reason& reason : report().reasons) text.append(reason.view()).append("\n");
  return text;
}

}  // namespace roomcal::press::test
