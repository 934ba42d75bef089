// What a shot's pictures and clouds show, against its truth by textbook formulas: from the files alone, nothing of the
// simulator's or the runtime's geometry.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "tools/common/files.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/record_lidar.h"
#include "tools/simulate/room_files.h"
#include "tools/simulate/shot_files.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {
namespace {

using nlohmann::json;

constexpr double kHundredthPixel = 0.01, kTenthMillimetre = 1e-4;

/// A camera as camchain.yaml has it.
struct TextbookCamera {
  bool fisheye = false;
  std::array<double, 4> k{}, d{};  ///< fx fy cx cy; distortion

  Vec2 project(const Vec3& p) const {
    if (fisheye) {
      const double rho = std::hypot(p.x(), p.y()), theta = std::atan2(rho, p.z()), t2 = theta * theta;
      const double r = theta * (1 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3])))) / rho;
      return {k[0] * r * p.x() + k[2], k[1] * r * p.y() + k[3]};
    }
    const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y, radial = 1 + r2 * (d[0] + r2 * d[1]);
    return {k[0] * (x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x)) + k[2],
            k[1] * (y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y) + k[3]};
  }
};

std::array<double, 4> four_numbers(const std::string& line) {
  std::array<double, 4> v{};
  EXPECT_EQ(std::sscanf(line.c_str() + line.find('['), "[%lf, %lf, %lf, %lf]", &v[0], &v[1], &v[2], &v[3]), 4);
  return v;
}

TextbookCamera read_camera(const std::filesystem::path& camchain, const std::string& name) {
  std::istringstream lines(read_text(camchain));
  TextbookCamera camera;
  std::string line;
  bool mine = false;
  while (std::getline(lines, line)) {
    if (line[0] != ' ') mine = line == name + ":";
    if (!mine) continue;
    if (line.find("equidistant") != std::string::npos) camera.fisheye = true;
    if (line.find("intrinsics:") != std::string::npos) camera.k = four_numbers(line);
    if (line.find("distortion_coeffs:") != std::string::npos) camera.d = four_numbers(line);
  }
  return camera;
}

/// Rows of a 4 x 4 transform, applied by hand.
struct Rows {
  std::array<std::array<double, 4>, 4> T;

  Vec3 forth(const Vec3& p) const {
    Vec3 q;
    for (std::size_t i = 0; i < 3; ++i)
      q[static_cast<int>(i)] = T[i][0] * p.x() + T[i][1] * p.y() + T[i][2] * p.z() + T[i][3];
    return q;
  }
  Vec3 back(const Vec3& p) const {
    const Vec3 d(p.x() - T[0][3], p.y() - T[1][3], p.z() - T[2][3]);
    Vec3 q;
    for (std::size_t i = 0; i < 3; ++i) q[static_cast<int>(i)] = T[0][i] * d.x() + T[1][i] * d.y() + T[2][i] * d.z();
    return q;
  }
};

Rows pose_in(const json& truth, const std::string& sensor) {
  return {truth.at("T_room_sensor").at(sensor).at("T").get<std::array<std::array<double, 4>, 4>>()};
}

struct CsvMarker {
  int id = 0;
  Vec3 centre, normal;
  double radius = 0;
};

std::vector<CsvMarker> read_markers(const std::filesystem::path& csv) {
  std::istringstream lines(read_text(csv));
  std::string line;
  std::getline(lines, line);
  std::vector<CsvMarker> markers;
  while (std::getline(lines, line)) {
    CsvMarker m;
    EXPECT_EQ(std::sscanf(line.c_str(), "%d,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &m.id, &m.centre.x(), &m.centre.y(),
                          &m.centre.z(), &m.normal.x(), &m.normal.y(), &m.normal.z(), &m.radius),
              8);
    markers.push_back(m);
  }
  return markers;
}

/// Image of a circle about a marker's centre. @param share  of the marker's radius
std::vector<Vec2> circle(const CsvMarker& marker, double share, const Rows& T_room_cam, const TextbookCamera& camera) {
  const Vec3 any = std::abs(marker.normal.z()) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 u = (any - marker.normal * marker.normal.dot(any)).normalized();
  const Vec3 v(marker.normal.y() * u.z() - marker.normal.z() * u.y(),
               marker.normal.z() * u.x() - marker.normal.x() * u.z(),
               marker.normal.x() * u.y() - marker.normal.y() * u.x());
  std::vector<Vec2> outline;
  for (int i = 0; i < 720; ++i) {
    const double a = 2 * kPi * i / 720;
    const Vec3 p_room = marker.centre + share * marker.radius * (std::cos(a) * u + std::sin(a) * v);
    outline.push_back(camera.project(T_room_cam.back(p_room)));
  }
  return outline;
}

/// Area (sign by sense) and first moment of a polygon.
std::pair<double, Vec2> area_of(const std::vector<Vec2>& outline, const Vec2& about) {
  double area = 0;
  Vec2 moment = Vec2::Zero();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 a = outline[i] - about, b = outline[(i + 1) % outline.size()] - about;
    const double twice = a.x() * b.y() - a.y() * b.x();
    area += twice / 2;
    moment += twice / 6 * (a + b);
  }
  return {area, moment};
}

bool within(const std::vector<Vec2>& outline, const Vec2& p) {
  bool in = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Vec2 &a = outline[i], &b = outline[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      in = !in;
  }
  return in;
}

/// Where the ink of a marker has its centre, by its circles.
Vec2 true_ink_centre(const CsvMarker& marker, const Rows& T_room_cam, const TextbookCamera& camera, const Vec2& about) {
  double area = 0, sign = 1;
  Vec2 moment = Vec2::Zero();
  for (const double share : {1.0, 0.85, 0.70, 0.55, 0.40, 0.25}) {
    const auto [a, m] = area_of(circle(marker, share, T_room_cam, camera), about);
    area += sign * a;
    moment += sign * m;
    sign = -sign;
  }
  return about + moment / area;
}

/// The same in the picture. @param mask  around all ink, on paper
Vec2 seen_ink_centre(const cv::Mat& image, const std::vector<Vec2>& mask, const Vec2& about, double paper) {
  Vec2 low = mask[0], high = mask[0];
  for (const Vec2& p : mask) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double sum = 0;
  Vec2 moment = Vec2::Zero();
  for (int y = static_cast<int>(low.y()); y <= high.y() + 1; ++y) {
    for (int x = static_cast<int>(low.x()); x <= high.x() + 1; ++x) {
      if (!within(mask, Vec2(x, y))) continue;
      const double dark = paper - image.at<uint8_t>(y, x);
      sum += dark;
      moment += dark * (Vec2(x, y) - about);
    }
  }
  return about + moment / sum;
}

class IndependentTruth : public testing::Test {
 protected:
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("roomcal_independent_truth_" + std::to_string(getpid()));
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// A shot as the program makes it, without noise and in even light. @param cameras  that take pictures
  void shoot(const std::string& name, double scale, std::size_t cameras, double waviness_m = 0) {
    RoomOptions room;
    room.seed = 8;
    room.waviness_m = waviness_m;
    Scene scene = make_room(room);
    scene.lamps.clear();
    scene.ambient = 1;
    write_room(scene, folder_);
    ShotOptions options;
    options.seed = 12;
    options.noise_sigma = 0;
    options.vignetting = 0;
    options.lidar.sigma_m = 0;
    options.lidar.sweeps = 1;
    options.lidar.tls_step_rad = deg_to_rad(2);
    PaperDevice device = scaled(device_named(name), scale);
    const Stand stand = place_device(scene, device, options);
    const LitScene lit(scene);
    ShotFacts facts;
    for (std::size_t i = 0; i < stand.cameras.size(); ++i) {
      Picture picture;
      if (i < cameras) picture = take_picture(lit, stand.cameras[i], options, i);
      if (i < cameras) write_picture(picture, stand.cameras[i].name, {}, folder_);
      facts.pictures.push_back(picture);
    }
    const EchoCaster caster(scene);
    for (const TrueLidar& lidar : stand.lidars) {
      facts.recordings.push_back(record_lidar(caster, lidar, options.lidar, 5));
      for (const ShotFile& file : facts.recordings.back().files) write_atomic(folder_ / file.name, file.bytes);
    }
    write_shot_facts(scene, stand, facts, options, folder_);
  }

  json read_json(const char* name) const { return json::parse(read_text(folder_ / name)); }

  /// @param bar_px  of every marker that is whole, large enough and off the picture's border
  void check_picture(const std::string& name, int at_least, double bar_px) const {
    const json truth = read_json("truth.json");
    const TextbookCamera camera = read_camera(folder_ / "camchain.yaml", name);
    const Rows T_room_cam = pose_in(truth, name);
    const cv::Mat image = cv::imread((folder_ / (name + ".png")).string(), cv::IMREAD_GRAYSCALE);
    const auto markers = read_markers(folder_ / "markers.csv");
    constexpr double kMask = 1.117, kPaper = 244;  // between ink and the sheet's end; 240 and the black level of 4
    double worst = 0;
    int judged = 0;
    for (const json& seen : truth.at("cameras").at(name).at("markers")) {
      const CsvMarker& marker = markers.at(seen.at("id").get<std::size_t>());
      const Vec2 centre = camera.project(T_room_cam.back(marker.centre));
      ASSERT_LT((centre - Vec2(seen.at("uv")[0].get<double>(), seen.at("uv")[1].get<double>())).norm(), 1e-6);
      if (seen.at("minor_px").get<double>() < 40) continue;
      const auto mask = circle(marker, kMask, T_room_cam, camera);
      const bool whole = std::all_of(mask.begin(), mask.end(), [&](const Vec2& p) {
        return p.minCoeff() > 2 && p.x() < image.cols - 3 && p.y() < image.rows - 3;
      });
      if (!whole) continue;
      const Vec2 expected = true_ink_centre(marker, T_room_cam, camera, centre);
      worst = std::max(worst, (seen_ink_centre(image, mask, centre, kPaper) - expected).norm());
      ++judged;
    }
    EXPECT_LT(worst, bar_px) << name;
    EXPECT_GE(judged, at_least) << name;
    RecordProperty("worst_px", std::to_string(worst));
    RecordProperty("markers", judged);
  }

  /// Range along a ray by planes.json.
  static double range_by_planes(const json& planes, const Vec3& from, const Vec3& along) {
    double nearest = 1e9;
    for (const json& plane : planes) {
      const Vec3 n(plane.at("normal")[0].get<double>(), plane.at("normal")[1].get<double>(),
                   plane.at("normal")[2].get<double>());
      if (n.dot(along) >= 0) continue;
      nearest = std::min(nearest, -(n.dot(from) + plane.at("d").get<double>()) / n.dot(along));
    }
    return nearest;
  }

  /// Measured minus true range of every point of a recording, its laser's bias taken off.
  std::vector<double> range_errors(const std::string& file, const std::string& kind) const {
    const json truth = read_json("truth.json"), planes = read_json("planes.json").at("planes");
    const Rows T_room_lidar = pose_in(truth, "lidar0");
    const json& lidar = truth.at("lidars").at("lidar0");
    LoadRequest request;
    request.file = folder_ / file;
    request.model = kind;
    std::vector<double> errors;
    for (const LoadedSweep& sweep : load_sweeps(request).sweeps) {
      for (const lidar::SweepPoint& p : sweep.points) {
        const Vec3 p_lidar(static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m));
        const Vec3 from = T_room_lidar.forth(Vec3::Zero()), along = (T_room_lidar.forth(p_lidar) - from).normalized();
        const double bias = kind == "tls" ? 0 : lidar.at("laser_bias_m")[p.beam].get<double>();
        errors.push_back(p_lidar.norm() - bias - range_by_planes(planes, from, along));
      }
    }
    return errors;
  }
};

TEST_F(IndependentTruth, NarrowPicture_ShowsMarkersToAHundredthPixel) {
  shoot("stereo_rig", 0.7, 1);
  check_picture("cam0", 15, kHundredthPixel);
}

TEST_F(IndependentTruth, FisheyePicture_ShowsMarkersToAHundredthPixel) {
  shoot("mobile_robot", 1.2, 1);
  check_picture("cam0", 15, kHundredthPixel);
}

TEST_F(IndependentTruth, WavyWalls_ShowMarkersWhereTruthSays) {
  shoot("stereo_rig", 0.7, 1, 0.001);
  check_picture("cam0", 15, 0.05);  // sheets bend with the wall, which the flat circles here do not
}

TEST_F(IndependentTruth, ScannersCloud_LiesOnThePlanesToATenthMillimetre) {
  shoot("tls", 0.02, 0);
  const auto errors = range_errors("lidar0.pcd", "tls");
  EXPECT_GT(errors.size(), 15'000U);
  for (const double error_m : errors) ASSERT_LT(std::abs(error_m), kTenthMillimetre);
}

TEST_F(IndependentTruth, SpinningLidarsPackets_AreRightToTheirSteps) {
  shoot("mobile_robot", 0.02, 0);
  const auto errors = range_errors("lidar0.pcap", "vlp16");
  EXPECT_GT(errors.size(), 28'000U);
  double sum = 0;
  for (const double error_m : errors) {
    ASSERT_LT(std::abs(error_m),
              0.001 + 0.0015);  // half a step; an azimuth in hundredths of a degree on a slanted wall
    sum += error_m;
  }
  EXPECT_LT(std::abs(sum / static_cast<double>(errors.size())), kTenthMillimetre);
}

}  // namespace
}  // namespace roomcal::tools
