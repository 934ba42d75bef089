// Every export is read back by a reader that we did not write, and must give the worked point that it carries.

#include <array>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <tinyxml2.h>
#include <yaml-cpp/yaml.h>

#include "runtime/export/export.h"
#include "tests/runtime/store/sample_record.h"

namespace roomcal::exports {
namespace {

constexpr double kTolerance = 1e-6;  // m, px

// operator+ of strings trips -Wrestrict of GCC 12 (bug 105651).
std::string joined(std::initializer_list<std::string_view> parts) {
  std::string all;
  for (const std::string_view part : parts) all.append(part);
  return all;
}

store::Record sample(std::size_t cameras, std::size_t lidars) {
  store::Record record = store::test::sample_record(11, cameras, lidars);
  for (std::size_t i = 1; i < cameras; i += 2) {
    record.sensors[i].intrinsics.model = camera::Model::kKannalaBrandt;
    record.sensors[i].intrinsics.distortion = {0.01, -0.005, 0.001, -0.0002};
  }
  return record;
}

std::string text_of(const store::Record& record, Format format, std::string_view camera = {}) {
  std::vector<char> buffer(32768);
  TextWriter out(buffer);
  const Status status = write(record, format, camera, out);
  EXPECT_TRUE(status.ok()) << status.detail();
  return std::string(out.view());
}

// The numbers of "worked point: (x, y, z) in NAME is (X, Y, Z) in NAME", and the first name.
struct Comment {
  std::vector<double> numbers;
  std::string sensor;
  Vec3 p_sensor() const { return {numbers.at(0), numbers.at(1), numbers.at(2)}; }
  Vec3 p_other() const { return {numbers.at(3), numbers.at(4), numbers.at(5)}; }
};

// Takes what is between two marks and moves `text` behind the second one.
std::string between(std::string_view& text, std::string_view first, std::string_view second) {
  const std::size_t from = text.find(first);
  const std::size_t to = from == std::string_view::npos ? from : text.find(second, from + first.size());
  if (to == std::string_view::npos) {
    ADD_FAILURE() << "no \"" << first << "...\"" << second << "\" in " << text;
    return {};
  }
  const std::string found(text.substr(from + first.size(), to - from - first.size()));
  text.remove_prefix(to + second.size());
  return found;
}

Comment comment_of(const std::string& text) {
  std::string_view rest = text;
  rest.remove_prefix(std::min(text.find("worked point: "), text.size()));
  rest = rest.substr(0, rest.find('\n'));
  Comment comment;
  std::string numbers = between(rest, "(", ")");
  comment.sensor = between(rest, "in ", " is ");
  while (rest.find('(') != std::string_view::npos) numbers.append(",").append(between(rest, "(", ")"));
  std::istringstream words(numbers);
  for (std::string word; std::getline(words, word, ',');) comment.numbers.push_back(std::stod(word));
  return comment;
}

Mat33 rotation(double roll, double pitch, double yaw) {
  return Eigen::AngleAxisd(yaw, Vec3::UnitZ()).toRotationMatrix() *
         Eigen::AngleAxisd(pitch, Vec3::UnitY()).toRotationMatrix() *
         Eigen::AngleAxisd(roll, Vec3::UnitX()).toRotationMatrix();
}

void expect_near(const Vec3& a, const Vec3& b) {
  EXPECT_LT((a - b).norm(), kTolerance) << a.transpose() << " | " << b.transpose();
}

TEST(KalibrExport, YamlCppChainsTheCameras_GivesTheWorkedPoint) {
  const std::string text = text_of(sample(4, 1), Format::kKalibr);
  const YAML::Node chain = YAML::Load(text);
  ASSERT_EQ(chain.size(), 4U);  // Kalibr takes every top-level key for a camera
  Mat44 T_cam_first = Mat44::Identity();
  for (std::size_t n = 1; n < chain.size(); ++n) {
    const YAML::Node rows = chain[joined({"cam", std::to_string(n)})]["T_cn_cnm1"];
    Mat44 T;
    for (int i = 0; i < 16; ++i) T(i / 4, i % 4) = rows[i / 4][i % 4].as<double>();
    T_cam_first = T * T_cam_first;
  }
  const Comment comment = comment_of(text);
  EXPECT_EQ(comment.sensor, "cam3");
  expect_near((T_cam_first.inverse() * comment.p_sensor().homogeneous()).head<3>(), comment.p_other());
  EXPECT_EQ(chain["cam1"]["distortion_model"].as<std::string>(), "equidistant");
  EXPECT_EQ(chain["cam0"]["distortion_coeffs"].as<std::vector<double>>(),
            (std::vector<double>{-0.25, 0.0625, 1e-4, -2e-4}));
  EXPECT_EQ(chain["cam0"]["resolution"].as<std::vector<int>>(), (std::vector<int>{1280, 800}));
  EXPECT_EQ(chain["cam2"]["intrinsics"][1].as<double>(), 700.5);
}

TEST(UrdfExport, XmlParserReadsTheJoints_GivesTheWorkedPoint) {
  const store::Record record = sample(2, 2);
  const std::string text = text_of(record, Format::kUrdf);
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(text.c_str()), tinyxml2::XML_SUCCESS) << document.ErrorStr();
  const Comment comment = comment_of(text);
  bool found = false;
  int joints = 0;
  for (const auto* joint = document.FirstChildElement("robot")->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint"), ++joints) {
    if (std::string(joint->Attribute("name")) != joined({"rig_to_", comment.sensor})) continue;
    found = true;
    EXPECT_STREQ(joint->FirstChildElement("child")->Attribute("link"),
                 joined({comment.sensor, "_sensor_frame"}).c_str());
    std::array<double, 6> v{};
    const auto* origin = joint->FirstChildElement("origin");
    std::istringstream(joined({origin->Attribute("xyz"), " ", origin->Attribute("rpy")})) >> v[0] >> v[1] >> v[2] >>
        v[3] >> v[4] >> v[5];
    expect_near(rotation(v[3], v[4], v[5]) * comment.p_sensor() + Vec3(v[0], v[1], v[2]), comment.p_other());
  }
  EXPECT_TRUE(found);
  EXPECT_EQ(joints, 4);
}

TEST(RosTfExport, XmlParserReadsTheQuaternions_GivesTheWorkedPoint) {
  const std::string text = text_of(sample(3, 0), Format::kRosTf);
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(text.c_str()), tinyxml2::XML_SUCCESS) << document.ErrorStr();
  const Comment comment = comment_of(text);
  bool found = false;
  for (const auto* node = document.FirstChildElement("launch")->FirstChildElement("node"); node != nullptr;
       node = node->NextSiblingElement("node")) {
    std::istringstream words(node->Attribute("args"));
    std::map<std::string, std::string> args;
    for (std::string key, value; words >> key >> value;) args[key] = value;
    if (args["--child-frame-id"] != joined({comment.sensor, "_optical_frame"})) continue;
    found = true;
    const auto value = [&](const char* key) { return std::stod(args.at(key)); };
    const Eigen::Quaterniond q(value("--qw"), value("--qx"), value("--qy"), value("--qz"));
    EXPECT_NEAR(q.norm(), 1, 1e-12);
    expect_near(q * comment.p_sensor() + Vec3(value("--x"), value("--y"), value("--z")), comment.p_other());
  }
  EXPECT_TRUE(found);
}

TEST(CameraInfoExport, OpenCvProjects_TheWorkedPoint) {
  const store::Record record = sample(2, 0);
  for (const std::string name : {"cam0", "cam1"}) {
    const std::string text = text_of(record, Format::kRosInfo, name);
    const YAML::Node info = YAML::Load(text);
    const Comment comment = comment_of(text);
    const auto K = info["camera_matrix"]["data"].as<std::vector<double>>();
    const auto D = info["distortion_coefficients"]["data"].as<std::vector<double>>();
    const std::vector<cv::Point3d> point{{comment.numbers[0], comment.numbers[1], comment.numbers[2]}};
    const cv::Mat K_cv(3, 3, CV_64F, const_cast<double*>(K.data()));
    std::vector<cv::Point2d> px;
    const cv::Vec3d zero(0, 0, 0);
    if (info["distortion_model"].as<std::string>() == "equidistant")
      cv::fisheye::projectPoints(point, px, zero, zero, K_cv, D);
    else
      cv::projectPoints(point, zero, zero, K_cv, D, px);
    ASSERT_EQ(comment.numbers.size(), 8U);
    EXPECT_NEAR(px[0].x, comment.numbers[6], kTolerance) << name;
    EXPECT_NEAR(px[0].y, comment.numbers[7], kTolerance) << name;
    expect_near(record.find(name)->T_rig_sensor * comment.p_sensor(), comment.p_other());
    EXPECT_EQ(info["camera_name"].as<std::string>(), name);
    EXPECT_EQ(info["projection_matrix"]["data"].size(), 12U);
  }
}

TEST(AutowareExport, YamlCppReadsRollPitchYaw_GivesTheWorkedPoint) {
  const store::Record record = sample(2, 1);
  const std::string text = text_of(record, Format::kAutoware);
  const YAML::Node kit = YAML::Load(text)["sensor_kit_base_link"];
  ASSERT_EQ(kit.size(), 3U);
  const Comment comment = comment_of(text);
  const YAML::Node lidar = kit[joined({comment.sensor, "_base_link"})];
  const auto value = [&](const char* key) { return lidar[key].as<double>(); };
  expect_near(rotation(value("roll"), value("pitch"), value("yaw")) * comment.p_sensor() +
                  Vec3(value("x"), value("y"), value("z")),
              comment.p_other());
  // The reference camera's body is the kit's origin with the same axes.
  for (const char* key : {"x", "y", "z", "roll", "pitch", "yaw"})
    EXPECT_NEAR(kit["cam0/camera_link"][key].as<double>(), 0, 1e-12);
}

TEST(AutowareExport, CameraLink_LooksAlongX) {
  // A camera 1 m to the right of the reference, turned to look to the right.
  store::Record record = sample(2, 0);
  record.sensors[1].T_rig_sensor = {Eigen::AngleAxisd(kPi / 2, Vec3::UnitY()).toRotationMatrix(), Vec3(1, 0, 0)};
  const YAML::Node link = YAML::Load(text_of(record, Format::kAutoware))["sensor_kit_base_link"]["cam1/camera_link"];
  EXPECT_NEAR(link["y"].as<double>(), -1, 1e-12);  // right is -y
  EXPECT_NEAR(link["yaw"].as<double>(), -kPi / 2, 1e-12);
  EXPECT_NEAR(link["pitch"].as<double>(), 0, 1e-12);
}

TEST(OpenCvExport, FileStorageReads_GivesTheWorkedPoint) {
  const store::Record record = sample(3, 1);
  const cv::FileStorage file(text_of(record, Format::kOpenCv), cv::FileStorage::READ | cv::FileStorage::MEMORY);
  ASSERT_TRUE(file.isOpened());
  EXPECT_EQ(static_cast<int>(file["nb_camera"]), 3);
  const cv::FileNode worked = file["worked_point"];
  cv::Mat T, p_sensor, p_rig, K;
  EXPECT_EQ(static_cast<std::string>(worked["sensor"]), static_cast<std::string>(file["lidar_0"]["name"]));
  file["lidar_0"]["camera_pose_matrix"] >> T;
  worked["p_sensor"] >> p_sensor;
  worked["p_rig"] >> p_rig;
  const cv::Mat mapped = T(cv::Rect(0, 0, 3, 3)) * p_sensor + T(cv::Rect(3, 0, 1, 3));
  EXPECT_LT(cv::norm(mapped - p_rig), kTolerance);
  file["camera_1"]["camera_matrix"] >> K;
  EXPECT_EQ(K.at<double>(0, 2), record.sensors[1].intrinsics.cx_px);
  EXPECT_EQ(static_cast<int>(file["camera_1"]["distortion_type"]), 1);
  EXPECT_EQ(static_cast<int>(file["camera_0"]["distortion_type"]), 0);
}

TEST(JsonExport, NlohmannReads_GivesTheWorkedPointAndEveryBit) {
  const store::Record record = sample(2, 1);
  const nlohmann::json json = nlohmann::json::parse(text_of(record, Format::kJson));
  const nlohmann::json& worked = json["worked_point"];
  const nlohmann::json& sensor = json["sensors"][worked["sensor"].get<std::string>()];
  Mat44 T;
  for (std::size_t i = 0; i < 16; ++i)
    T(static_cast<int>(i / 4), static_cast<int>(i % 4)) = sensor["T_rig_sensor"][i / 4][i % 4];
  const auto vec = [](const nlohmann::json& v) { return Vec3(v[0], v[1], v[2]); };
  expect_near((T * vec(worked["p_sensor"]).homogeneous()).head<3>(), vec(worked["p_rig"]));
  EXPECT_EQ(T, record.sensors[2].T_rig_sensor.matrix());
  for (std::size_t i = 0; i < 36; ++i)
    EXPECT_EQ(sensor["covariance"][i / 6][i % 6].get<double>(),
              record.sensors[2].cov_rig_sensor(static_cast<int>(i / 6), static_cast<int>(i % 6)));
  EXPECT_EQ(json["verdict"], "PASS_ADVISE");
  EXPECT_EQ(json["previous_content"], nullptr);
  EXPECT_EQ(json["temperature_c"], 23.5);
  EXPECT_EQ(json["trigger"], "line");
}

}  // namespace
}  // namespace roomcal::exports
