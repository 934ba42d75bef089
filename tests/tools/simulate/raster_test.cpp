#include "tools/simulate/raster.h"

#include <atomic>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

/// A vertical edge at x = edge, 0 left and 100 right of it; parts are averaged exactly.
class Edge final : public Radiance {
 public:
  explicit Edge(double edge) : edge_(edge) {}
  void sample(int x, int, PixelSamples& samples) const override {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double left = x + sub_offset_px(static_cast<int>(i % kSub)) - 0.5 / kSub;
      samples[i] = static_cast<float>(100 * std::clamp((left + 1.0 / kSub - edge_) * kSub, 0.0, 1.0));
    }
  }

 private:
  double edge_;
};

/// 100 x integral of the normal distribution over a pixel square and what lies right of the edge.
double blurred_edge(double distance, double sigma) {
  const auto integral = [&](double x) {  // of the normal distribution function
    return x * 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))) +
           sigma / std::sqrt(2 * std::acos(-1.0)) * std::exp(-x * x / (2 * sigma * sigma));
  };
  return 100 * (integral(distance + 0.5) - integral(distance - 0.5));
}

TEST(Integrate, SharpEdge_GivesPixelArea) {
  const RadianceImage image = integrate(Edge(10.3), 20, 5, {.psf_sigma_px = 0});
  EXPECT_NEAR(image.at(9, 2), 0, 1e-4);
  EXPECT_NEAR(image.at(10, 2), 20, 1e-4);
  EXPECT_NEAR(image.at(11, 2), 100, 1e-4);
}

TEST(Integrate, BlurredEdge_FollowsTheContinuousConvolution) {
  for (const double sigma : {0.4, 0.6, 1.5}) {
    for (const double edge : {30.0, 30.17, 30.5, 30.81}) {
      const RadianceImage image = integrate(Edge(edge), 60, 3, {.psf_sigma_px = sigma});
      for (int x = 0; x < 60; ++x) EXPECT_NEAR(image.at(x, 1), blurred_edge(x - edge, sigma), 0.6) << sigma << " " << x;
    }
  }
}

TEST(Integrate, Motion_KeepsTheMiddle) {
  const RadianceImage image = integrate(Edge(30), 60, 3, {.psf_sigma_px = 0.6, .motion_px = 6});
  EXPECT_NEAR(image.at(30, 1), 50, 0.1);
  EXPECT_NEAR(image.at(27, 1) + image.at(33, 1), 100, 0.1);
  EXPECT_NEAR(image.at(32, 1) - image.at(28, 1), 100.0 * 4 / 6, 1);
}

/// The same edge lying down: y in place of x.
class LyingEdge final : public Radiance {
 public:
  explicit LyingEdge(double edge) : edge_(edge) {}
  void sample(int x, int y, PixelSamples& samples) const override {
    PixelSamples upright;
    edge_.sample(y, x, upright);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = upright[i % kSub * kSub + i / kSub];
  }

 private:
  Edge edge_;
};

/// 100 x share of a disc, of this diameter about the middle of a pixel, right of an edge; mean over the pixel.
double defocused_edge(double distance, double diameter) {
  const double R = diameter / 2;
  double sum = 0;
  constexpr int kSteps = 200;
  for (int i = 0; i < kSteps; ++i) {
    const double x = std::clamp(distance + (i + 0.5) / kSteps - 0.5, -R, R);
    sum += 0.5 + (x * std::sqrt(R * R - x * x) + R * R * std::asin(x / R)) / (std::acos(-1.0) * R * R);
  }
  return 100 * sum / kSteps;
}

TEST(Integrate, Defocus_SpreadsPointsToEvenDiscs) {
  for (const double diameter : {1.5, 3.0, 7.3}) {
    const Blur blur{.psf_sigma_px = 0, .defocus_px = diameter};
    const RadianceImage upright = integrate(Edge(30.3), 60, 9, blur), lying = integrate(LyingEdge(30.3), 9, 60, blur);
    for (int i = 20; i < 40; ++i) {
      EXPECT_NEAR(upright.at(i, 4), defocused_edge(i - 30.3, diameter), 1) << diameter << " " << i;
      EXPECT_NEAR(lying.at(4, i), defocused_edge(i - 30.3, diameter), 1) << diameter << " " << i;
    }
  }
}

TEST(Integrate, DefocusBelowASample_ChangesNothing) {
  EXPECT_EQ(integrate(Edge(30.3), 60, 9, {.psf_sigma_px = 0.6, .defocus_px = 0.1}).values,
            integrate(Edge(30.3), 60, 9, {.psf_sigma_px = 0.6}).values);
}

TEST(Integrate, BandsOfRows_LeaveNoSeam) {
  const RadianceImage image = integrate(Edge(30), 60, 200, {.psf_sigma_px = 1});
  for (int y = 1; y < 200; ++y) EXPECT_FLOAT_EQ(image.at(30, y), image.at(30, 0));
  const Blur defocus{.psf_sigma_px = 1, .defocus_px = 5};
  const RadianceImage lying = integrate(LyingEdge(96.2), 40, 200, defocus),
                      upright = integrate(Edge(96.2), 200, 40, defocus);
  for (int y = 80; y < 112; ++y) EXPECT_NEAR(lying.at(20, y), upright.at(y, 20), 0.6);  // 96: a band ends there
}

TEST(ParallelFor, EveryIndex_OnceAndFailuresArrive) {
  std::array<std::atomic<int>, 100> calls{};
  parallel_for(100, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
  for (const auto& count : calls) EXPECT_EQ(count, 1);
  EXPECT_THROW(parallel_for(10,
                            [](int i) {
                              if (i == 5) throw std::runtime_error("x");
                            }),
               std::runtime_error);
}

}  // namespace
}  // namespace roomcal::tools
