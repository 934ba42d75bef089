#include "tools/evaluate/detector_bound.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

FieldOptions field_of(double diameter_px, double slant_deg, double gradient = 0) {
  FieldOptions options;
  options.lens = {camera::Model::kPinholeRadtan, 400, 300, 1500, 1500, 199.5, 149.5, {}};
  options.diameter_px = diameter_px;
  options.slant_rad = deg_to_rad(slant_deg);
  options.gradient = gradient;
  return options;
}

CentreBound bound_of(const MarkerField& field) {
  return centre_bound(field.markers()[0], field.camera(), field.options(), 0.6);
}

/// The bound's smooth model against the renderer: information about the centre from two rendered pictures that differ
/// by a small shift.
TEST(CentreBound, CentreAlone_AgreesWithDifferencesOfRenderedPictures) {
  for (const double slant_deg : {0.0, 60.0}) {
    const auto render = [&](const Vec2& shift_px) {
      FieldOptions options = field_of(80, slant_deg);
      options.shift_px = shift_px;
      return integrate(MarkerField(options), 400, 300, {.psf_sigma_px = 0.6});
    };
    constexpr double kShift_px = 0.05;
    const RadianceImage left = render(Vec2(-kShift_px, 0)), right = render(Vec2(kShift_px, 0));
    const RadianceImage up = render(Vec2(0, -kShift_px)), down = render(Vec2(0, kShift_px));
    const MarkerField field(field_of(80, slant_deg));
    const FieldMarker& marker = field.markers()[0];
    const Vec3 normal = marker.axis_u_cam.cross(marker.axis_v_cam);
    Mat22 information = Mat22::Zero();
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 400; ++x) {
        const Vec3 ray((x - 199.5) / 1500, (y - 149.5) / 1500, 1);
        const double radius = (ray * (normal.dot(marker.centre_cam) / normal.dot(ray)) - marker.centre_cam).norm();
        if (radius > 1.12) continue;  // this marker, without the ends of its sheet
        const Vec2 gradient = Vec2(right.at(x, y) - left.at(x, y), down.at(x, y) - up.at(x, y)) / (2 * kShift_px);
        information += gradient * gradient.transpose();
      }
    }
    const Mat22 product = bound_of(field).cov_known_px2 * information;
    EXPECT_LT((product - Mat22::Identity()).norm(), 0.03) << product;
  }
}

TEST(CentreBound, FrontalMarker_IsTheSameInBothAxes) {
  const MarkerField field(field_of(40, 0));
  const Eigen::SelfAdjointEigenSolver<Mat22> axes(bound_of(field).cov_px2);
  EXPECT_LT(axes.eigenvalues()[1] / axes.eigenvalues()[0], 1.05);
}

TEST(CentreBound, MoreUnknowns_NeverHelp) {
  for (const double slant_deg : {0.0, 45.0, 70.0}) {
    const CentreBound bound = bound_of(MarkerField(field_of(40, slant_deg, 0.3)));
    const auto smallest = [](const Mat22& m) { return Eigen::SelfAdjointEigenSolver<Mat22>(m).eigenvalues()[0]; };
    EXPECT_GT(smallest(bound.cov_px2 - bound.cov_known_px2), 0);
    EXPECT_GT(smallest(bound.cov_full_px2 - bound.cov_px2), -1e-12);
  }
}

TEST(CentreBound, LargerMarkers_AreKnownBetter) {
  double last = 1;
  for (const double diameter : {15.0, 30.0, 60.0, 110.0}) {
    const double trace = bound_of(MarkerField(field_of(diameter, 30))).cov_px2.trace();
    EXPECT_LT(trace, last);
    last = trace;
  }
}

}  // namespace
}  // namespace roomcal::tools
