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

TEST(Integrate, BandsOfRows_LeaveNoSeam) {
  const RadianceImage image = integrate(Edge(30), 60, 200, {.psf_sigma_px = 1});
  for (int y = 1; y < 200; ++y) EXPECT_FLOAT_EQ(image.at(30, y), image.at(30, 0));
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
