#include "tools/simulate/record_lidar.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/make_room.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {
namespace {

const Scene& room() {
  static const Scene scene = make_room({.seed = 9, .pillar = true});
  return scene;
}

TrueLidar lidar_of(const std::string& unit) {
  TrueLidar lidar{.name = "lidar0", .unit = unit, .kind = unit, .unit_seed = 17};
  lidar.T_room_lidar = {so3_exp(Vec3(0.6, -0.3, 0.9)), Vec3(1.2, 1.7, 1.1)};
  std::size_t beams = 1;
  if (unit != kTlsKind) {
    const auto made = make_lidar_unit(unit, lidar.unit_seed, 0);
    beams = made->beams();
    lidar.kind = made->model();
  }
  lidar.beam_offset_m.assign(beams, 0);
  return lidar;
}

/// Through the folder, as a shot has them: the reader finds the unit's file there.
class RecordLidar : public testing::Test {
 protected:
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("roomcal_record_lidar_" + std::to_string(getpid()));
  void SetUp() override { make_folder(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Recording decode(const LidarRecording& made, const std::string& model, std::size_t file = 0) const {
    for (const ShotFile& written : made.files) write_atomic(folder_ / written.name, written.bytes);
    LoadRequest request;
    request.model = model;
    request.file = folder_ / made.files[file].name;
    if (made.files.size() > 1 && file == 0 && model != kTlsKind) request.calibration = folder_ / made.files[1].name;
    return load_sweeps(request);
  }
};

LidarRecording record(const TrueLidar& lidar, const LidarOptions& options, uint64_t seed = 5) {
  return record_lidar(EchoCaster(room()), lidar, options, seed);
}

std::size_t whole_sweeps(const Recording& recording) {
  std::size_t count = 0;
  for (const LoadedSweep& sweep : recording.sweeps) count += sweep.facts.flags == 0 ? 1 : 0;
  return count;
}

/// Distance of a point to the nearest wall, from plane equations alone.
double off_walls_m(const Vec3& p_room) {
  double nearest = 1e9;
  for (const Plane& wall : room().walls) nearest = std::min(nearest, std::abs(wall.signed_distance(p_room)));
  for (const Body& body : room().bodies)
    for (const Plane& face : body.faces) nearest = std::min(nearest, std::abs(face.signed_distance(p_room)));
  return nearest;
}

/// What a unit's packets leave of a point's distance to its wall.
struct UnitBar {
  const char* unit;
  double range_m;    ///< half a step of its ranges
  double azimuth_m;  ///< what azimuths in hundredths of a degree do at 5 m and under a flat angle
};

class RecordUnit : public RecordLidar, public testing::WithParamInterface<UnitBar> {};

TEST_P(RecordUnit, DecodesToWholeSweepsOnTheWalls) {
  const TrueLidar lidar = lidar_of(GetParam().unit);
  const LidarRecording made = record(lidar, {.sweeps = 3});
  const Recording recording = decode(made, lidar.kind);
  EXPECT_TRUE(recording.report.warnings.empty());
  EXPECT_TRUE(recording.report.refused.empty());
  EXPECT_EQ(whole_sweeps(recording), 3U);
  std::size_t points = 0, paper = 0, ink = 0;
  std::vector<bool> seen(lidar.beam_offset_m.size());
  double worst_m = 0;
  for (const LoadedSweep& sweep : recording.sweeps) {
    for (std::size_t i = 0; i < sweep.points.size(); ++i, ++points) {
      worst_m = std::max(worst_m, off_walls_m(lidar.T_room_lidar * sweep.view().position_lidar(i)));
      paper += sweep.points[i].reflectivity > 75 ? 1U : 0U;
      ink += sweep.points[i].reflectivity < 15 ? 1U : 0U;
      seen.at(sweep.points[i].beam) = true;
    }
  }
  EXPECT_LT(worst_m, GetParam().range_m + GetParam().azimuth_m + 1e-6);
  EXPECT_GT(worst_m, 0.5 * GetParam().range_m);  // rounded to its steps, and to no others
  EXPECT_EQ(points, made.returns);
  EXPECT_GT(paper, points / 20);
  EXPECT_GT(ink, points / 100);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), static_cast<std::ptrdiff_t>(seen.size()));
}

INSTANTIATE_TEST_SUITE_P(Units, RecordUnit,
                         testing::Values(UnitBar{"vlp16", 0.001, 0.0008}, UnitBar{"vlp32c", 0.002, 0.0008},
                                         UnitBar{"xt32", 0.002, 0}, UnitBar{"os0-32", 0.0005, 0},
                                         UnitBar{"os1-64", 0.0005, 0}),
                         [](const auto& which) {
                           std::string name = which.param.unit;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_F(RecordLidar, BeamOffsets_AreInTheRanges) {
  TrueLidar lidar = lidar_of("vlp16");
  const Recording plain = decode(record(lidar, {.sweeps = 1}), lidar.kind);
  for (std::size_t beam = 0; beam < 16; ++beam) lidar.beam_offset_m[beam] = 0.002 * static_cast<double>(beam) - 0.01;
  const Recording off = decode(record(lidar, {.sweeps = 1}), lidar.kind);
  ASSERT_EQ(plain.sweeps[0].points.size(), off.sweeps[0].points.size());
  for (std::size_t i = 0; i < plain.sweeps[0].points.size(); ++i) {
    const lidar::SweepPoint &a = plain.sweeps[0].points[i], &b = off.sweeps[0].points[i];
    ASSERT_NEAR(static_cast<double>(b.range_m - a.range_m), lidar.beam_offset_m[a.beam], 1e-5);
  }
}

TEST_F(RecordLidar, NoiseAndDropout_AreWhatWasAsked) {
  TrueLidar lidar = lidar_of("vlp16");
  const LidarRecording quiet = record(lidar, {.sweeps = 2});
  EXPECT_EQ(quiet.returns, quiet.firings);
  LidarOptions options{.sweeps = 2};
  options.dropout = 0.2;
  const LidarRecording gaps = record(lidar, options);
  const auto share = static_cast<double>(gaps.returns) / static_cast<double>(gaps.firings);
  EXPECT_NEAR(share, 0.8, 4 * std::sqrt(0.16 / static_cast<double>(gaps.firings)));

  lidar.sigma_m = 0.02;
  const Recording noisy = decode(record(lidar, {.sweeps = 2}), lidar.kind);
  const Recording truth = decode(quiet, lidar.kind);
  double squares = 0;
  const std::size_t count = truth.sweeps[0].points.size();
  for (std::size_t i = 0; i < count; ++i)
    squares += std::pow(static_cast<double>(noisy.sweeps[0].points[i].range_m - truth.sweeps[0].points[i].range_m), 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)), 0.02, 0.0005);
}

TEST_F(RecordLidar, MixedPixels_FloatBetweenSurfaces) {
  const TrueLidar lidar = lidar_of("vlp16");
  const auto floating = [&](bool mixed_pixels) {
    LidarOptions options{.sweeps = 5};
    options.mixed_pixels = mixed_pixels;
    std::size_t count = 0;
    for (const LoadedSweep& sweep : decode(record(lidar, options), lidar.kind).sweeps)
      for (std::size_t i = 0; i < sweep.points.size(); ++i)
        count += off_walls_m(lidar.T_room_lidar * sweep.view().position_lidar(i)) > 0.02 ? 1U : 0U;
    return count;
  };
  EXPECT_EQ(floating(false), 0U);
  EXPECT_GT(floating(true), 5U);
  EXPECT_LT(floating(true), 500U);
}

TEST_F(RecordLidar, Tls_CoversTheSphereWithPointsOnTheWalls) {
  const TrueLidar lidar = lidar_of(kTlsKind);
  const LidarRecording made = record(lidar, {.tls_step_rad = deg_to_rad(3)});
  EXPECT_EQ(made.files[0].name, "lidar0.pcd");
  const Recording recording = decode(made, lidar.kind);
  ASSERT_EQ(recording.sweeps.size(), 1U);
  const lidar::Sweep sweep = recording.sweeps[0].view();
  ASSERT_EQ(sweep.points.size(), 60U * 120U);
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    ASSERT_LT(off_walls_m(lidar.T_room_lidar * sweep.position_lidar(i)), 1e-5);
    const Vec3 along = sweep.position_lidar(i).normalized();
    low = low.cwiseMin(along);
    high = high.cwiseMax(along);
  }
  EXPECT_LT(low.maxCoeff(), -0.99);
  EXPECT_GT(high.minCoeff(), 0.99);
}

TEST_F(RecordLidar, TlsProfilesAndServo_MakeTheCloud) {
  const TrueLidar lidar = lidar_of(kTlsKind);
  LidarOptions options{.tls_step_rad = deg_to_rad(0.7)};  // the scanner takes 0.675 degree, which has whole steps
  options.tls_profiles = true;
  const LidarRecording made = record(lidar, options);
  const Recording cloud = decode(made, lidar.kind), profiles = decode(made, "r2000", 1);
  ASSERT_TRUE(profiles.report.warnings.empty());
  std::istringstream servo(read_text(folder_ / "lidar0_servo.csv"));
  std::string line;
  std::getline(servo, line);
  EXPECT_EQ(line, "stamp_ns,angle_rad");
  std::size_t point = 0;
  for (const LoadedSweep& profile : profiles.sweeps) {
    ASSERT_EQ(profile.facts.flags, 0U);
    long long stamp_ns = 0;
    double angle_rad = 0;
    ASSERT_TRUE(std::getline(servo, line));
    ASSERT_EQ(std::sscanf(line.c_str(), "%lld,%lf", &stamp_ns, &angle_rad), 2);
    ASSERT_NEAR(static_cast<double>(profile.facts.stamp.ns - stamp_ns), 0, 2);
    const Vec3 forward(std::sin(angle_rad), 0, std::cos(angle_rad));
    for (const lidar::SweepPoint& p : profile.points) {
      const Vec3 p_lidar = static_cast<double>(p.x_m) * forward - static_cast<double>(p.y_m) * Vec3::UnitY();
      ASSERT_LT((p_lidar - cloud.sweeps[0].view().position_lidar(point++)).norm(), 0.00051);
    }
  }
  EXPECT_EQ(point, cloud.sweeps[0].points.size());
}

TEST_F(RecordLidar, SameSeed_SameBytes) {
  TrueLidar lidar = lidar_of("vlp16");
  lidar.sigma_m = 0.015;
  EXPECT_EQ(record(lidar, {.sweeps = 1}, 5).files[0].bytes, record(lidar, {.sweeps = 1}, 5).files[0].bytes);
  EXPECT_NE(record(lidar, {.sweeps = 1}, 5).files[0].bytes, record(lidar, {.sweeps = 1}, 6).files[0].bytes);
}

TEST_F(RecordLidar, OtherShotOfAUnit_HasTheSameAngles) {
  const TrueLidar lidar = lidar_of("xt32");
  TrueLidar other = lidar;
  other.unit_seed += 1;
  EXPECT_EQ(record(lidar, {.sweeps = 1}, 5).files[1].bytes, record(lidar, {.sweeps = 1}, 6).files[1].bytes);
  EXPECT_NE(record(lidar, {.sweeps = 1}, 5).files[1].bytes, record(other, {.sweeps = 1}, 5).files[1].bytes);
}

TEST_F(RecordLidar, UnknownUnit_SaysWhatThereIs) {
  try {
    make_lidar_unit("sonar", 1, 0);
    FAIL();
  } catch (const ToolError& error) {
    EXPECT_NE(std::string(error.what()).find("os1-64"), std::string::npos);
  }
}

}  // namespace
}  // namespace roomcal::tools
