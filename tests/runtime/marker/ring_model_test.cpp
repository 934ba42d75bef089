#include "runtime/marker/ring_model.h"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "runtime/marker/reduce_marker.h"
#include "tests/runtime/marker/outer_ellipse.h"
#include "tests/truth/marker_patch.h"

namespace roomcal::marker {
namespace {

// Where the circle's centre is in the frame of its outer ellipse.
Vec2 shift_of(const Ellipse& outer, const Vec2& centre_px) {
  const Vec2 axis(std::cos(outer.angle_rad), std::sin(outer.angle_rad));
  const Vec2 d = centre_px - outer.centre_px;
  return {2 * d.dot(axis) / outer.major_px, 2 * (d.y() * axis.x() - d.x() * axis.y()) / outer.minor_px};
}

TEST(RingModel, EllipseAndShift_AreTheHomographyThatMadeThem) {
  const Vec2 centre_px(700.3, 640.8);
  for (const double slant_deg : {0.0, 30.0, 60.0, 75.0}) {
    for (const double azimuth_rad : {0.3, 2.0, 4.4}) {
      const Mat33 H_px_plane = truth::marker_homography(centre_px, 800, deg_to_rad(slant_deg), azimuth_rad, 0.7, 1100);
      const Ellipse outer = outer_ellipse(H_px_plane);
      const Vec2 shift = shift_of(outer, centre_px);
      if (slant_deg >= 30) {
        EXPECT_GT(shift.norm(), 0.1) << "too far away to test the shift";
      }
      const RingModel model = model_from_ellipse(outer, shift);
      EXPECT_LT((model.centre_px() - centre_px).norm(), 1e-6);
      for (const double radius : {0.25, 0.7, 1.0, 1.1}) {
        for (const double angle : {0.0, 1.0, 2.5, 4.0}) {
          const Vec2 on_plane = radius * Vec2(std::cos(angle), std::sin(angle));
          const Vec2 point_px = (H_px_plane * on_plane.homogeneous()).hnormalized();
          EXPECT_NEAR(radius_at(model, point_px), radius, 1e-9) << slant_deg << " degrees";
        }
      }
    }
  }
}

// A picture of planes: what the reduced model says of a reduced pixel is what the full one says of its middle.
TEST(ReduceMarker, ReducedModel_IsTheSameMarker) {
  std::vector<uint8_t> grey(900 * 800);
  for (int y = 0; y < 800; ++y)
    for (int x = 0; x < 900; ++x) grey[static_cast<std::size_t>(y * 900 + x)] = static_cast<uint8_t>((x + y) / 8);
  const ImageView image(grey.data(), 900, 800);
  RingModel model = model_from_ellipse({{450.4, 390.7}, 620, 500, 0.4}, {0.1, -0.15});
  model[kLight0] = 180;
  model[kLightX] = 12;
  model[kLightY] = -7;
  model[kBlur] = 0.8 / model.scale_px;
  ASSERT_TRUE(wants_reduction(model));
  std::vector<std::byte> memory(reduced_bytes());
  Arena arena(memory);
  ReducedMarker reduced;
  ASSERT_TRUE(reduce_marker(image, model, 1.15, arena, reduced).ok());
  ASSERT_GT(reduced.factor, 1);
  // Where a pixel of the reduced picture lies in the full one, by its grey level's plane and by the models' centres.
  const Vec2 offset_px = model.centre_px() - reduced.factor * reduced.model.centre_px();
  for (const Vec2& at : {Vec2(10, 12), Vec2(40, 70), Vec2(90, 33)}) {
    const Vec2 full_px = reduced.factor * at + offset_px;
    EXPECT_NEAR(reduced.image(static_cast<int>(at.x()), static_cast<int>(at.y())), full_px.sum() / 8, 1.0);
    EXPECT_NEAR(radius_at(reduced.model, at), radius_at(model, full_px), 1e-9);
    const auto light = [](const RingModel& m, const Vec2& p) {
      const Vec2 x = (p - m.origin_px) / m.scale_px;
      return m[kLight0] + m[kLightX] * x.x() + m[kLightY] * x.y();
    };
    EXPECT_NEAR(light(reduced.model, at), light(model, full_px), 1e-9);
  }
  RingModel back = model;
  take_from_reduced(reduced, back);
  for (int i = 0; i < model.parameters(); ++i) EXPECT_NEAR(back[i], model[i], 1e-12) << i;
}

TEST(ReduceMarker, MarkerOutsideTheImage_IsTooFew) {
  std::vector<uint8_t> grey(100 * 100);
  std::vector<std::byte> memory(reduced_bytes());
  Arena arena(memory);
  ReducedMarker reduced;
  const RingModel model = model_from_ellipse({{900, 900}, 400, 400, 0});
  EXPECT_EQ(reduce_marker({grey.data(), 100, 100}, model, 1.15, arena, reduced).code(), StatusCode::kTooFew);
}

}  // namespace
}  // namespace roomcal::marker
