#include "runtime/marker/ring_block.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::marker {
namespace {

RingModel slanted_model() {
  RingModel model = model_from_ellipse({{103.3, 98.7}, 60, 38, 0.7});
  model.rings = 3;
  model[kLineX] = 0.04;
  model[kLineY] = -0.02;
  model[kLight0] = 190;
  model[kLightX] = 20;
  model[kLightY] = -12;
  model[kInk] = 0.2;
  model[kBlur] = 0.9 / model.scale_px;
  const double radii[] = {0.85, 0.70, 0.55, 0.40, 0.25};
  for (int i = 0; i < 5; ++i) model[kFirstRadius + i] = radii[i];
  return model;
}

// One block of pixels near a given radius.
struct BlockPixels {
  std::vector<float> x, y, grey;
  RingPixels view() { return {x, y, grey, static_cast<int>(x.size())}; }
};

BlockPixels pixels_near(const RingModel& model, double radius) {
  BlockPixels pixels;
  Ellipse ellipse;
  EXPECT_TRUE(ellipse_of_radius(model, radius, ellipse));
  for (int i = 0; i < kBlockPixels; ++i) {
    const double phi = 2 * kPi * i / kBlockPixels;
    const Vec2 along{std::cos(ellipse.angle_rad), std::sin(ellipse.angle_rad)};
    const Vec2 p = ellipse.centre_px + ellipse.major_px / 2 * std::cos(phi) * along +
                   ellipse.minor_px / 2 * std::sin(phi) * Vec2{-along.y(), along.x()};
    pixels.x.push_back(static_cast<float>((p.x() - model.origin_px.x()) / model.scale_px));
    pixels.y.push_back(static_cast<float>((p.y() - model.origin_px.y()) / model.scale_px));
    pixels.grey.push_back(100);
  }
  return pixels;
}

TEST(RingBlock, JacobianAtEveryEdge_AgreesWithDifferences) {
  const RingModel model = slanted_model();
  const ResidualWeighting no_weighting{1e9};
  for (int edge = 0; edge < model.edges(); ++edge) {
    BlockPixels pixels = pixels_near(model, model.radius(edge));
    RingBlock block, plus, minus;
    evaluate_block(model, pixels.view(), 0, no_weighting, block);
    for (int row = 0; row + 1 < block.rows; ++row) {
      const int parameter = block.parameter[static_cast<std::size_t>(row)];
      const double step =
          2e-3 * (parameter >= kLight0 && parameter <= kLightY ? 100 : 1) * (parameter == kBlur ? 0.5 : 1);
      RingModel moved = model;
      moved[parameter] += step;
      evaluate_block(moved, pixels.view(), 0, no_weighting, plus);
      moved[parameter] -= 2 * step;
      evaluate_block(moved, pixels.view(), 0, no_weighting, minus);
      // Blur and a neighbour's radius show little here: their scale is the step's height over sigma.
      double largest = parameter >= kBlur ? 0.24 * model.contrast() / model[kBlur] : 1e-3;
      for (const float value : block.row[row]) largest = std::fmax(largest, std::fabs(static_cast<double>(value)));
      for (int i = 0; i < kBlockPixels; ++i) {
        // The residual is data minus model. |grad r|, bend and shift are held fixed by design: a few per cent.
        const double numeric = -static_cast<double>(plus.residual[i] - minus.residual[i]) / (2 * step);
        EXPECT_NEAR(static_cast<double>(block.row[row][i]), numeric, 0.08 * largest + 0.3)
            << "edge " << edge << " parameter " << parameter << " pixel " << i;
      }
    }
  }
}

TEST(RingBlock, Accumulate_EqualsPlainSums) {
  const RingModel model = slanted_model();
  BlockPixels pixels = pixels_near(model, 0.7);
  const ResidualWeighting weighting{20};
  RingBlock block;
  evaluate_block(model, pixels.view(), 0, weighting, block);
  NormalEquations equations;
  accumulate(block, equations);
  for (int a = 0; a + 1 < block.rows; ++a) {
    double gradient = 0;
    for (int i = 0; i < kBlockPixels; ++i) {
      gradient += static_cast<double>(block.row[a][i]) * static_cast<double>(block.row[block.rows - 1][i]);
    }
    const int parameter = block.parameter[static_cast<std::size_t>(a)];
    EXPECT_NEAR(equations.gradient(parameter), gradient, 1e-4 * std::fabs(gradient) + 1e-2);
    for (int b = a; b + 1 < block.rows; ++b) {
      double product = 0;
      for (int i = 0; i < kBlockPixels; ++i) {
        product += static_cast<double>(block.row[a][i]) * static_cast<double>(block.row[b][i]);
      }
      EXPECT_NEAR(equations.hessian(parameter, block.parameter[static_cast<std::size_t>(b)]), product,
                  1e-4 * std::fabs(product) + 1e-1);
    }
  }
}

TEST(RingBlock, ClippedPixels_CarryNoWeightWhereTheModelAgrees) {
  RingModel model = slanted_model();
  model[kLight0] = 300;
  BlockPixels pixels = pixels_near(model, 1.12);
  for (float& grey : pixels.grey) grey = 255;
  RingBlock block;
  evaluate_block(model, pixels.view(), 0, {50}, block);
  for (const float weight : block.weight) EXPECT_EQ(weight, 0.0F);
}

TEST(RingModel, EllipseRoundTrip_KeepsAxesAndAngle) {
  for (const double angle : {-1.2, 0.0, 0.4, 1.5}) {
    const Ellipse ellipse{{40.3, 77.7}, 52, 23, angle};
    const RingModel model = model_from_ellipse(ellipse);
    Ellipse again;
    ASSERT_TRUE(ellipse_of_radius(model, 1, again));
    EXPECT_NEAR(again.major_px, ellipse.major_px, 1e-9);
    EXPECT_NEAR(again.minor_px, ellipse.minor_px, 1e-9);
    EXPECT_NEAR(std::sin(again.angle_rad - angle), 0, 1e-9);
    EXPECT_NEAR((again.centre_px - ellipse.centre_px).norm(), 0, 1e-9);
  }
}

}  // namespace
}  // namespace roomcal::marker
