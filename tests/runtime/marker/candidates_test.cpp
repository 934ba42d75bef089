#include "runtime/marker/candidates.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/marker/scene.h"
#include "tests/truth/marker_patch.h"

namespace roomcal::marker {
namespace {

using truth::MarkerPatch;

// Candidates of an image, found with no more memory than the function says it needs.
std::vector<Candidate> find(ImageView image, CandidateList* counts = nullptr) {
  std::vector<std::byte> memory(candidates_bytes(image.width(), image.height()));
  Arena arena{std::span<std::byte>(memory)};
  CandidateList list;
  const Status status = find_candidates(image, DetectorOptions{}, arena, list);
  EXPECT_TRUE(status.ok()) << status.detail();
  if (counts != nullptr) *counts = list;
  return {list.items.begin(), list.items.begin() + static_cast<std::ptrdiff_t>(list.count)};
}

// The candidate around a point whose major axis is within `part` of the wanted one.
const Candidate* near(const std::vector<Candidate>& all, const Vec2& centre_px, double major_px, double part = 0.1) {
  for (const Candidate& one : all)
    if ((one.outer.centre_px - centre_px).norm() < 0.06 * major_px + 0.8 &&
        std::abs(one.outer.major_px - major_px) < part * major_px + 1)
      return &one;
  return nullptr;
}

struct View {
  double diameter_px, slant_deg;
};

class CandidateViews : public testing::TestWithParam<View> {};

TEST_P(CandidateViews, MarkerOfAnyAzimuth_IsFoundWithItsOuterEllipse) {
  const View view = GetParam();
  const int azimuths = view.diameter_px > 150 ? 1 : 8;  // large ones take long to render
  for (int i = 0; i < azimuths; ++i) {
    MarkerPatch patch = centred_marker(view.diameter_px, view.slant_deg, 0.4 * i);
    patch.seed = static_cast<uint32_t>(i + 1);
    const std::vector<uint8_t> pixels = truth::render(patch);
    EXPECT_NE(near(find(truth::view(patch, pixels)), patch.centre_px(), view.diameter_px), nullptr)
        << "azimuth step " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(SizesAndSlants, CandidateViews,
                         testing::Values(View{15, 0}, View{15, 45}, View{20, 30}, View{30, 0}, View{30, 70},
                                         View{45, 60}, View{90, 75}, View{200, 45}, View{900, 10}));

TEST(Candidates, FiveRings_AreCountedAndFound) {
  MarkerPatch patch = centred_marker(120, 30);
  patch.radii = {1, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1};
  const std::vector<uint8_t> pixels = truth::render(patch);
  const std::vector<Candidate> found = find(truth::view(patch, pixels));
  const Candidate* marker = near(found, patch.centre_px(), 120);
  ASSERT_NE(marker, nullptr);
  EXPECT_EQ(marker->rings, 5);
}

TEST(Candidates, BlurOfThreePixels_KeepsTheMarker) {
  MarkerPatch patch = centred_marker(90, 20);
  patch.blur_px = 3;
  const std::vector<uint8_t> pixels = truth::render(patch);
  EXPECT_NE(near(find(truth::view(patch, pixels)), patch.centre_px(), 90), nullptr);
}

TEST(Candidates, NoiseOfTenGreyLevels_KeepsTheMarker) {
  MarkerPatch patch = centred_marker(80, 20);
  patch.noise_grey = 10;
  const std::vector<uint8_t> pixels = truth::render(patch);
  EXPECT_NE(near(find(truth::view(patch, pixels)), patch.centre_px(), 80), nullptr);
}

TEST(Candidates, ContrastOfThirtyGreyLevels_KeepsTheMarker) {
  MarkerPatch patch = centred_marker(50, 30);
  patch.ink = 20;
  patch.paper = 50;
  patch.background = 30;
  const std::vector<uint8_t> pixels = truth::render(patch);
  EXPECT_NE(near(find(truth::view(patch, pixels)), patch.centre_px(), 50), nullptr);
}

TEST(Candidates, HardShadowAcrossTheMiddle_KeepsTheMarker) {
  MarkerPatch patch = centred_marker(90, 20);
  patch.shadow_normal = Vec2(0.8, 0.6);
  patch.shadow_offset_px = patch.shadow_normal.dot(patch.centre_px());
  patch.shadow = 0.5;
  const std::vector<uint8_t> pixels = truth::render(patch);
  EXPECT_NE(near(find(truth::view(patch, pixels)), patch.centre_px(), 90), nullptr);
}

TEST(Candidates, BorderThroughTheLightDisc_GivesACandidateThatTouchesIt) {
  const MarkerPatch patch = centred_marker(120, 10);
  Scene scene(400, 300, 110);
  // The centre lies 8 px inside the image; the light disc has a radius of 15 px.
  scene.paste(patch, 8 - static_cast<int>(patch.centre_px().x()), 40);
  const Vec2 centre_px(8 + patch.centre_px().x() - std::floor(patch.centre_px().x()), 40 + patch.centre_px().y());
  const std::vector<Candidate> found = find(scene.view());
  const Candidate* marker = near(found, centre_px, 120);
  ASSERT_NE(marker, nullptr);
  EXPECT_TRUE(marker->touches_border);
}

TEST(Candidates, WholeMarker_DoesNotTouchTheBorder) {
  const MarkerPatch patch = centred_marker(60, 10);
  const std::vector<uint8_t> pixels = truth::render(patch);
  const std::vector<Candidate> found = find(truth::view(patch, pixels));
  const Candidate* marker = near(found, patch.centre_px(), 60);
  ASSERT_NE(marker, nullptr);
  EXPECT_FALSE(marker->touches_border);
}

TEST(Candidates, FlatImage_HasNone) {
  for (const int level : {0, 128, 255}) {
    const Scene scene(200, 150, static_cast<uint8_t>(level));
    EXPECT_TRUE(find(scene.view()).empty()) << level;
  }
}

TEST(Candidates, SmallestImage_IsRead) {
  Scene scene(16, 16, 200);
  scene.at(8, 8) = 10;
  EXPECT_TRUE(find(scene.view()).empty());
}

TEST(Candidates, PureNoise_StaysWithinItsMemory) {
  Scene scene(333, 251, 0);
  uint32_t state = 7;
  for (uint8_t& pixel : scene.pixels) {
    state = state * 1664525U + 1013904223U;
    pixel = static_cast<uint8_t>(state >> 24);
  }
  CandidateList counts;
  find(scene.view(), &counts);
  EXPECT_LE(counts.count, candidate_capacity(333, 251));
}

TEST(Candidates, CheckerboardOfSinglePixels_StaysWithinItsMemory) {
  Scene scene(257, 129, 0);
  for (int y = 0; y < scene.height; ++y)
    for (int x = 0; x < scene.width; ++x) scene.at(x, y) = (x + y) % 2 == 0 ? 20 : 220;
  find(scene.view());
}

TEST(Candidates, StridedView_GivesTheSameAsADenseOne) {
  const MarkerPatch patch = centred_marker(40, 20);
  Scene scene(patch.width + 37, patch.height, 0);
  scene.paste(patch, 0, 0);
  const ImageView strided(scene.pixels.data(), patch.width, patch.height, scene.width);
  const std::vector<uint8_t> pixels = truth::render(patch);
  const std::vector<Candidate> a = find(strided);
  const std::vector<Candidate> b = find(truth::view(patch, pixels));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].outer.centre_px, b[i].outer.centre_px);
}

TEST(Candidates, ArenaFullAtAnyPoint_ReportsOutOfMemory) {
  const MarkerPatch patch = centred_marker(40, 20);
  const std::vector<uint8_t> pixels = truth::render(patch);
  const std::size_t need = candidates_bytes(patch.width, patch.height);
  std::vector<std::byte> memory(need);
  for (std::size_t bytes = 0; bytes < need / 2; bytes += need / 40) {
    Arena arena{std::span<std::byte>(memory.data(), bytes)};
    CandidateList list;
    EXPECT_EQ(find_candidates(truth::view(patch, pixels), {}, arena, list).code(), StatusCode::kOutOfMemory) << bytes;
  }
}

}  // namespace
}  // namespace roomcal::marker
