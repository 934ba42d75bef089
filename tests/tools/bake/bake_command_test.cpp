// Bad input at the command's door: a clear line, and a map that was there before stays whole.
#include "tools/bake/bake_command.h"

#include <csignal>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/resource.h>

#include "tests/tools/bake/synthetic_survey.h"
#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tools/bake/survey_json.h"
#include "tools/common/files.h"
#include "tools/common/image_io.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;
using test::contains;
using test::refusal;

constexpr const char* kOldMap = "what was there before";

/// A camchain of the synthetic pair, as Kalibr writes it.
std::string camchain(const StereoRig& rig, double baseline_factor = 1, int width_px = 1280) {
  std::ostringstream out;
  out.precision(17);
  for (const Side side : kBothSides) {
    const camera::Intrinsics& k = rig.cameras[side].intrinsics();
    out << "cam" << side << ":\n  camera_model: pinhole\n  distortion_model: radtan\n  distortion_coeffs: ["
        << k.distortion[0] << ", " << k.distortion[1] << ", " << k.distortion[2] << ", " << k.distortion[3]
        << "]\n  intrinsics: [" << k.fx_px << ", " << k.fy_px << ", " << k.cx_px << ", " << k.cy_px
        << "]\n  resolution: [" << width_px << ", " << k.height_px << "]\n";
    if (side == kLeft) continue;
    out << "  T_cn_cnm1:\n";
    for (int row = 0; row < 3; ++row) {
      out << "  - [";
      for (int column = 0; column < 3; ++column) out << rig.T_right_left.R(row, column) << ", ";
      out << baseline_factor * rig.T_right_left.t[row] << "]\n";
    }
    out << "  - [0.0, 0.0, 0.0, 1.0]\n";
  }
  return out.str();
}

class BakeCommand : public test::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    put("chain.yaml", camchain(test::make_stereo_rig()));
    put("m.room", kOldMap);
  }

  void put(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  void put_survey(const test::SyntheticSurvey& s) const { put("survey.json", to_survey_json(s.survey, s.rig)); }
  void put_image(const std::string& name, int width, int height) const {
    fs::create_directories((folder_ / name).parent_path());
    write_image(folder_ / name, cv::Mat(height, width, CV_8UC1, cv::Scalar(128)));
  }

  void bake(const std::string& survey) const {
    CLI::App app;
    int exit_code = 0;
    add_bake_command(app, exit_code);
    std::vector<std::string> words{"bake", survey, "--stereo", file("chain.yaml"), "-o", file("m.room")};
    std::reverse(words.begin(), words.end());  // CLI11 wants them so
    app.parse(words);
  }

  /// The command refuses with `words`, and neither the old map nor the folder has changed.
  void expect_refused(const std::string& survey, const std::string& words) const {
    const std::string said = refusal([&] { bake(survey); });
    EXPECT_TRUE(contains(said, words)) << said;
    EXPECT_EQ(read_text(file("m.room")), kOldMap);
    EXPECT_FALSE(fs::exists(file("m.room.new")));
  }
};

TEST_F(BakeCommand, MissingSide_IsNamed) {
  put_image("walk/cam0/1.png", 1280, 1024);
  expect_refused(file("walk"), "cam1/ is missing");
}

TEST_F(BakeCommand, ImagesOfAnotherResolution_AreNamed) {
  for (const char* side : {"cam0", "cam1"}) put_image(std::string("walk/") + side + "/1.png", 640, 512);
  expect_refused(file("walk"), "640 x 512, but the calibration is for 1280 x 1024");
}

TEST_F(BakeCommand, ImagesWithoutMarkers_SaySo) {
  for (const char* side : {"cam0", "cam1"}) put_image(std::string("walk/") + side + "/1.png", 1280, 1024);
  expect_refused(file("walk"), "no markers in any left image");
}

TEST_F(BakeCommand, CalibrationOfAnotherPair_IsSaid) {
  test::SyntheticSurvey s = test::make_survey(1, 0.05, 6);
  put_survey(s);
  s.rig.T_right_left = {so3_exp({0.1, 0, 0.05}), Vec3(-0.3, 0.1, 0)};
  put("chain.yaml", camchain(s.rig));
  expect_refused(file("survey.json"), "the stereo calibration does not belong");
}

TEST_F(BakeCommand, CalibrationOfOneCamera_IsSaid) {
  const std::string chain = camchain(test::make_stereo_rig());
  put("chain.yaml", chain.substr(0, chain.find("cam1:")));
  put_survey(test::make_survey(1, 0.05, 6));
  expect_refused(file("survey.json"), "needs two cameras");
}

TEST_F(BakeCommand, SwappedSides_AreSaid) {
  test::SyntheticSurvey s = test::make_survey(2, 0.05, 6);
  for (StereoView& view : s.survey.views) std::swap(view.seen[kLeft], view.seen[kRight]);
  put_survey(s);
  expect_refused(file("survey.json"), "left and right are swapped");
}

TEST_F(BakeCommand, MapToExtendIsNoMap_IsRefusedBeforeTheWork) {
  put_survey(test::make_survey(3, 0.05, 6));
  CLI::App app;
  int exit_code = 0;
  add_bake_command(app, exit_code);
  std::vector<std::string> words{"bake",     file("survey.json"), "--stereo", file("chain.yaml"),
                                 "--extend", file("m.room"),      "-o",       file("n.room")};
  std::reverse(words.begin(), words.end());
  EXPECT_TRUE(contains(refusal([&] { app.parse(words); }), "not a room map"));
  EXPECT_FALSE(fs::exists(file("n.room")));
}

/// Writes past `bytes` fail, as on a full disk, while this lives.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST_F(BakeCommand, FullDisk_LeavesTheOldMapWhole) {
  put_survey(test::make_survey(4, 0.05, 12));
  std::string said;
  {
    const FullDisk full(4096);
    said = refusal([&] { bake(file("survey.json")); });
  }
  EXPECT_TRUE(contains(said, "m.room")) << said;
  EXPECT_EQ(read_text(file("m.room")), kOldMap);
  EXPECT_FALSE(fs::exists(file("m.room.new")));
}

}  // namespace
}  // namespace roomcal::tools
