#include "tools/simulate/marker_field.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

const camera::Intrinsics kPinhole{camera::Model::kPinholeRadtan, 400, 300, 1500, 1500, 199.5, 149.5, {}};
const camera::Intrinsics kFisheye{camera::Model::kKannalaBrandt, 400, 300, 500, 500, 199.5, 149.5,
                                  {-0.02, 0.005, -0.002, 4e-4}};

/// Centroid of darkness (paper minus grey) within a radius: the middle of a frontal marker, and a measure that knows
/// nothing of how the picture was made.
Vec2 dark_centroid(const RadianceImage& image, const Vec2& around, double radius, double paper) {
  double sum = 0;
  Vec2 moment = Vec2::Zero();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if ((Vec2(x, y) - around).norm() > radius) continue;
      const double dark = paper - image.at(x, y);
      sum += dark;
      moment += dark * (Vec2(x, y) - around);
    }
  }
  return around + moment / sum;
}

/// The same of the true geometry: ellipses of ink and paper, weighted by their areas.
Vec2 true_dark_centroid(const FieldMarker& marker, const camera::Camera& camera) {
  double sum = 0, sign = 1;
  Vec2 moment = Vec2::Zero();
  for (const double radius : kBestRings) {
    const CircleImage circle = circle_image(marker, camera, radius);
    sum += sign * circle.major_px * circle.minor_px;
    moment += sign * circle.major_px * circle.minor_px * circle.centre_px;
    sign = -sign;
  }
  return moment / sum;
}

RadianceImage render(const MarkerField& field, double blur_px) {
  return integrate(field, field.options().lens.width_px, field.options().lens.height_px, {blur_px, 0});
}

TEST(MarkerField, Markers_AreWhereTruthSays_BothLenses) {
  for (const camera::Intrinsics& lens : {kPinhole, kFisheye}) {
    for (const double diameter : {40.0, 60.0, 100.0}) {
      FieldOptions options;
      options.lens = lens;
      options.diameter_px = diameter;
      const MarkerField field(options);
      const RadianceImage image = render(field, 0.6);
      Vec2 mean = Vec2::Zero();
      for (const FieldMarker& marker : field.markers()) {
        const Vec2 measured = dark_centroid(image, marker.centre_px, 0.5 * diameter + 2.4, options.paper_grey);
        const Vec2 error = measured - true_dark_centroid(marker, field.camera());
        EXPECT_LT(error.norm(), 0.003) << diameter;
        mean += error / static_cast<double>(field.markers().size());
      }
      EXPECT_LT(mean.norm(), 0.001) << diameter;
    }
  }
}

TEST(MarkerField, Diameter_IsAsAsked) {
  for (const camera::Intrinsics& lens : {kPinhole, kFisheye}) {
    FieldOptions options;
    options.lens = lens;
    options.diameter_px = 30;
    options.slant_rad = deg_to_rad(50);
    const MarkerField field(options);
    ASSERT_GT(field.markers().size(), 20u);
    for (const FieldMarker& marker : field.markers()) {
      EXPECT_NEAR(circle_image(marker, field.camera(), 1).major_px, 30, 0.05);
    }
  }
}

TEST(MarkerField, Slant_IsAngleToTheRay) {
  FieldOptions options;
  options.lens = kFisheye;
  options.slant_rad = deg_to_rad(70);
  const MarkerField field(options);
  for (const FieldMarker& marker : field.markers()) {
    const Vec3 normal = marker.axis_u_cam.cross(marker.axis_v_cam);
    EXPECT_NEAR(std::acos(-normal.dot(marker.centre_cam.normalized())), options.slant_rad, 1e-9);
  }
}

TEST(MarkerField, Gradient_BrightensAlongItsAzimuth) {
  FieldOptions options;
  options.lens = kPinhole;
  options.diameter_px = 60;
  options.gradient = 0.3;
  const MarkerField field(options);
  const RadianceImage image = render(field, 0.6);
  const Vec2 c = field.markers().front().centre_px;
  const int x = static_cast<int>(std::lround(c.x())), y = static_cast<int>(std::lround(c.y()));
  // the paper between the outer two rings, at 0.775 radii
  const double left = image.at(x - 23, y), right = image.at(x + 23, y);
  EXPECT_NEAR((right - left) / options.paper_grey, 0.3 * 46 / 60, 0.01);
}

/// The quarter-pixel scheme against brute force: one pixel integrated over 256 x 256 points and a sampled Gaussian.
TEST(MarkerField, Pixels_AgreeWithBruteForceIntegration) {
  FieldOptions options;
  options.lens = {camera::Model::kPinholeRadtan, 40, 40, 1500, 1500, 19.5, 19.5, {}};
  options.diameter_px = 18;
  options.slant_rad = deg_to_rad(45);
  const MarkerField field(options);
  const double sigma = 0.5;
  const RadianceImage image = render(field, sigma);
  const FieldMarker& marker = field.markers().front();
  const Vec3 normal = marker.axis_u_cam.cross(marker.axis_v_cam);
  const auto point_grey = [&](const Vec2& px) {
    const Vec3 ray((px.x() - 19.5) / 1500, (px.y() - 19.5) / 1500, 1);
    const Vec3 offset = ray * (normal.dot(marker.centre_cam) / normal.dot(ray)) - marker.centre_cam;
    const double r = offset.norm();
    int circles_outside = 0;
    for (const double radius : kBestRings) circles_outside += r < radius ? 1 : 0;
    return circles_outside % 2 == 1 ? options.ink_grey : options.paper_grey;
  };
  const int x = static_cast<int>(std::lround(marker.centre_px.x())) + 3;
  const int y = static_cast<int>(std::lround(marker.centre_px.y())) - 1;
  constexpr int kPoints = 400;
  constexpr double kReach_px = 2.5;  // 0.5 of the square and 4 sigma
  double sum = 0, weights = 0;
  const auto weight = [&](double t) {
    return std::erf((t + 0.5) / (sigma * std::sqrt(2.0))) - std::erf((t - 0.5) / (sigma * std::sqrt(2.0)));
  };
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      const double dx = kReach_px * (2 * (i + 0.5) / kPoints - 1), dy = kReach_px * (2 * (j + 0.5) / kPoints - 1);
      sum += weight(dx) * weight(dy) * point_grey(Vec2(x + dx, y + dy));
      weights += weight(dx) * weight(dy);
    }
  }
  EXPECT_NEAR(image.at(x, y), sum / weights, 0.25);
}

}  // namespace
}  // namespace roomcal::tools
