#include "runtime/marker/detector.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/marker/scene.h"
#include "tests/truth/marker_patch.h"

namespace roomcal::marker {
namespace {

using truth::MarkerPatch;

struct Outcome {
  Status status;
  std::vector<Detection> markers;
  DetectorStats stats;
};

Outcome run(ImageView image, std::size_t room = 100, const DetectorOptions& options = {}) {
  std::vector<std::byte> memory(detector_scratch_bytes(image.width(), image.height()));
  Arena arena{std::span<std::byte>(memory)};
  Outcome outcome;
  outcome.markers.resize(room);
  std::size_t count = 0;
  outcome.status = detect(image, options, arena, outcome.markers, count, &outcome.stats);
  EXPECT_EQ(arena.used(), 0U);
  EXPECT_EQ(arena.refusals(), 0U);
  outcome.markers.resize(count);
  return outcome;
}

// Twelve markers of 30 to 63 px in a grid.
Scene grid_of_markers() {
  Scene scene(640, 480, 110);
  for (int i = 0; i < 12; ++i) {
    MarkerPatch patch = centred_marker(30 + 3 * i, 4.0 * i, 0.5 * i);
    patch.seed = static_cast<uint32_t>(i + 1);
    patch.width = patch.height = 150;
    const Vec2 centre(75, 75);
    patch.H_px_plane = truth::marker_homography(centre, patch.diameter_px, deg_to_rad(4.0 * i), 0.5 * i, 0.2 * i, 900);
    scene.paste(patch, 10 + 155 * (i % 4), 5 + 155 * (i / 4));
  }
  return scene;
}

TEST(Detector, GridOfMarkers_FindsEachOnce) {
  const Scene scene = grid_of_markers();
  const Outcome outcome = run(scene.view());
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.detail();
  ASSERT_EQ(outcome.markers.size(), 12U);
  for (int i = 0; i < 12; ++i) {
    const Vec2 truth_px(85 + 155 * (i % 4), 80 + 155 * (i / 4));
    const auto hits = std::count_if(outcome.markers.begin(), outcome.markers.end(), [&truth_px](const Detection& d) {
      return d.status == DetectionStatus::kOk && d.rings == 3 && (d.centre_px - truth_px).norm() < 0.1;
    });
    EXPECT_EQ(hits, 1) << "marker " << i;
  }
}

TEST(Detector, SameImageTwice_GivesTheSameBits) {
  const Scene scene = grid_of_markers();
  const Outcome a = run(scene.view());
  const Outcome b = run(scene.view());
  ASSERT_EQ(a.markers.size(), b.markers.size());
  for (std::size_t i = 0; i < a.markers.size(); ++i) {
    EXPECT_EQ(a.markers[i].centre_px, b.markers[i].centre_px);
    EXPECT_EQ(a.markers[i].cov_px2, b.markers[i].cov_px2);
  }
}

TEST(Detector, MoreMarkersThanRoom_ReportsCapacityAndHowManyNot) {
  const Scene scene = grid_of_markers();
  const Outcome outcome = run(scene.view(), 5);
  EXPECT_EQ(outcome.status.code(), StatusCode::kCapacity);
  EXPECT_EQ(outcome.markers.size(), 5U);
  EXPECT_EQ(outcome.stats.over_capacity, 7);
}

TEST(Detector, MarkerCutByTheBorder_IsReportedSoAndListedLast) {
  Scene scene(400, 300, 110);
  const MarkerPatch whole = centred_marker(60, 10);
  scene.paste(whole, 220, 60);
  const MarkerPatch cut = centred_marker(90, 10);
  scene.paste(cut, 30 - static_cast<int>(cut.centre_px().x()), 60);
  const Outcome outcome = run(scene.view());
  ASSERT_EQ(outcome.markers.size(), 2U);
  EXPECT_EQ(outcome.markers[0].status, DetectionStatus::kOk);
  EXPECT_EQ(outcome.markers[1].status, DetectionStatus::kCutByBorder);
}

TEST(Detector, PlainDiscsAndFewRings_AreNoMarkers) {
  const std::vector<std::vector<double>> prints{{1}, {1, 0.6}, {1, 0.8, 0.5, 0.3}, {1, 0.8, 0.5}};
  for (const std::vector<double>& radii : prints) {
    MarkerPatch patch = centred_marker(80, 25);
    patch.radii = radii;
    const std::vector<uint8_t> pixels = truth::render(patch);
    EXPECT_TRUE(run(truth::view(patch, pixels)).markers.empty()) << radii.size() << " circles";
  }
}

TEST(Detector, FanCheckerboardAndText_AreNoMarkers) {
  for (const auto print : {MarkerPatch::Print::kFan, MarkerPatch::Print::kCheckerboard, MarkerPatch::Print::kText}) {
    MarkerPatch patch = centred_marker(120, 15);
    patch.print = print;
    const std::vector<uint8_t> pixels = truth::render(patch);
    EXPECT_TRUE(run(truth::view(patch, pixels)).markers.empty()) << "print " << static_cast<int>(print);
  }
}

TEST(Detector, PureNoise_GivesNoMarker) {
  Scene scene(320, 240, 0);
  uint32_t state = 3;
  for (uint8_t& pixel : scene.pixels) {
    state = state * 1664525U + 1013904223U;
    pixel = static_cast<uint8_t>(state >> 24);
  }
  EXPECT_TRUE(run(scene.view()).markers.empty());
}

TEST(Detector, FlatImages_GiveNoMarker) {
  for (const int level : {0, 127, 255}) {
    const Scene scene(64, 48, static_cast<uint8_t>(level));
    const Outcome outcome = run(scene.view());
    EXPECT_TRUE(outcome.status.ok());
    EXPECT_TRUE(outcome.markers.empty());
  }
}

TEST(Detector, ImageTooSmall_IsRefused) {
  const Scene scene(15, 40, 100);
  EXPECT_EQ(run(scene.view()).status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(run(ImageView{}).status.code(), StatusCode::kInvalidArgument);
}

TEST(Detector, NoScratch_ReportsOutOfMemoryAndWritesNothing) {
  const Scene scene(64, 48, 100);
  Arena arena;
  std::vector<Detection> out(4);
  std::size_t count = 9;
  EXPECT_EQ(detect(scene.view(), {}, arena, out, count).code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(count, 0U);
}

TEST(Detector, Memory_OfAMegapixelCameraIsUnderFourMebibytes) {
  EXPECT_LE(detector_scratch_bytes(1280, 1024), std::size_t{4} << 20);
}

TEST(Detector, StatusNames_AreThoseOfTheJson) {
  EXPECT_EQ(std::string(to_string(DetectionStatus::kOk)), "ok");
  EXPECT_EQ(std::string(to_string(DetectionStatus::kCutByBorder)), "cut_by_border");
  EXPECT_EQ(std::string(to_string(DetectionStatus::kOccluded)), "occluded");
  EXPECT_EQ(std::string(to_string(DetectionStatus::kUnstable)), "unstable");
}

}  // namespace
}  // namespace roomcal::marker
