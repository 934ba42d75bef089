#include "runtime/grab/scene_patches.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/math/types.h"
#include "tests/truth/random.h"

namespace roomcal::grab {
namespace {

constexpr int kWidth = 640, kHeight = 480;

struct Light {
  double gain = 1, offset = 0, noise = 2;
};

/// A smooth pattern with texture in both directions, moved by a shift.
std::vector<uint8_t> picture(const Vec2& shift_px, const Light& light, uint64_t seed, double contrast = 60) {
  truth::Random random(seed);
  std::vector<uint8_t> grey;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = x - shift_px.x(), v = y - shift_px.y();
      const double level = 120 + contrast * std::sin(u / 4.1) * std::cos(v / 3.7);
      const double value = light.gain * level + light.offset + light.noise * random.normal();
      grey.push_back(static_cast<uint8_t>(std::clamp(value, 0.0, 255.0)));
    }
  }
  return grey;
}

ImageView view(const std::vector<uint8_t>& grey) { return {grey.data(), kWidth, kHeight}; }

SceneMotion motion_between(const std::vector<uint8_t>& before, const std::vector<uint8_t>& after) {
  ScenePatches patches;
  take_patches(view(before), patches);
  return compare_patches(patches, view(after));
}

TEST(ScenePatches, SameScene_StandsStillToAHundredthOfAPixel) {
  const SceneMotion motion = motion_between(picture({0, 0}, {}, 1), picture({0, 0}, {}, 2));
  EXPECT_EQ(motion.compared, kMaxPatches);
  EXPECT_EQ(motion.changed, 0U);
  EXPECT_LT(motion.median_px, 0.02);
  EXPECT_FALSE(has_moved(motion, {}));
}

TEST(ScenePatches, SmallShifts_AreMeasured) {
  for (const double shift_px : {0.1, 0.3, 0.6}) {
    for (const double azimuth : {0.0, 1.0, 2.5, 4.0}) {
      const Vec2 shift(shift_px * std::cos(azimuth), shift_px * std::sin(azimuth));
      const SceneMotion motion = motion_between(picture({0, 0}, {}, 1), picture(shift, {}, 2));
      EXPECT_NEAR(motion.median_px, shift_px, 0.02 + 0.1 * shift_px);
    }
  }
}

TEST(ScenePatches, FlickeringLight_IsNoMotion) {
  const SceneMotion motion = motion_between(picture({0, 0}, {}, 1), picture({0, 0}, {0.8, 12, 2}, 2));
  EXPECT_EQ(motion.changed, 0U);
  EXPECT_LT(motion.median_px, 0.03);
}

TEST(ScenePatches, FarShift_CountsAsChangedEverywhere) {
  const SceneMotion motion = motion_between(picture({0, 0}, {}, 1), picture({7, 5}, {}, 2));
  EXPECT_GT(motion.changed, motion.compared / 2);
  EXPECT_TRUE(has_moved(motion, {}));
}

TEST(ScenePatches, SomebodyInAPartOfThePicture_IsNoMotionOfTheDevice) {
  std::vector<uint8_t> after = picture({0, 0}, {}, 2);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 6; ++x) after[static_cast<std::size_t>(y * kWidth + x)] = 90;
  const SceneMotion motion = motion_between(picture({0, 0}, {}, 1), after);
  EXPECT_EQ(motion.changed, 4U);
  EXPECT_FALSE(has_moved(motion, {}));
}

TEST(ScenePatches, BlankWall_NothingCanBeSaid) {
  const SceneMotion motion = motion_between(picture({0, 0}, {}, 1, 0), picture({0, 0}, {}, 2, 0));
  EXPECT_EQ(motion.compared, 0U);
}

TEST(ScenePatches, ImageOfAnotherSize_NothingIsCompared) {
  ScenePatches patches;
  const std::vector<uint8_t> before = picture({0, 0}, {}, 1);
  take_patches(view(before), patches);
  EXPECT_EQ(compare_patches(patches, ImageView()).compared, 0U);
  take_patches(ImageView(before.data(), 40, 40), patches);
  EXPECT_TRUE(patches.patches.empty());
}

}  // namespace
}  // namespace roomcal::grab
