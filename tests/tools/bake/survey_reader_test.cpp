#include "tools/bake/survey_reader.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/tools/bake/synthetic_survey.h"
#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tools/bake/survey_json.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;
using test::contains;
using test::refusal;

/// Its files are empty, which is enough for pairing.
class SurveyFolder : public test::FolderTest {
 protected:
  void put(const std::string& name) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << ' ';
  }
};

TEST(NaturalLess, Numbers_CompareByValue) {
  EXPECT_TRUE(natural_less("frame9", "frame10"));
  EXPECT_FALSE(natural_less("frame10", "frame9"));
  EXPECT_TRUE(natural_less("a", "b"));
  EXPECT_FALSE(natural_less("a", "a"));
}

TEST_F(SurveyFolder, ImagesOfOneName_ArePairedInNaturalOrder) {
  for (const char* name : {"cam0/10.png", "cam0/9.png", "cam1/9.jpg", "cam1/10.PGM", "cam0/notes.txt"}) put(name);
  std::vector<std::string> remarks;
  const auto pairs = pair_images(folder_, remarks);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].first.filename(), "9.png");
  EXPECT_EQ(pairs[1].second.filename(), "10.PGM");
  EXPECT_TRUE(remarks.empty());
}

TEST_F(SurveyFolder, ImageWithoutPartner_IsRemarked) {
  for (const char* name : {"left/1.png", "left/2.png", "right/1.png", "left/3.png", "right/3.png"}) put(name);
  std::vector<std::string> remarks;
  EXPECT_EQ(pair_images(folder_, remarks).size(), 2U);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(contains(remarks[0], "2.png"));
}

TEST_F(SurveyFolder, OneSideMissing_SaysWhich) {
  put("cam0/1.png");
  std::vector<std::string> remarks;
  EXPECT_TRUE(contains(refusal([&] { pair_images(folder_, remarks); }), "cam1/ is missing"));
}

TEST_F(SurveyFolder, NamesThatDoNotMeet_IsRefused) {
  for (const char* name : {"cam0/1.png", "cam0/2.png", "cam1/a.png", "cam1/b.png"}) put(name);
  std::vector<std::string> remarks;
  EXPECT_TRUE(contains(refusal([&] { pair_images(folder_, remarks); }), "same name"));
}

TEST(SurveyJson, RoundTrip_KeepsEverySighting) {
  test::SyntheticSurvey s = test::make_survey(1, 0.1, 2);
  s.survey.views[0].seen[kLeft][0].ellipse = marker::Ellipse{{1, 2}, 40, 30, 0.5};
  const Survey again = parse_survey_json("s.json", to_survey_json(s.survey, s.rig), s.rig);
  ASSERT_EQ(again.views.size(), s.survey.views.size());
  EXPECT_EQ(again.views[1].seen[kRight].size(), s.survey.views[1].seen[kRight].size());
  EXPECT_EQ(again.views[0].seen[kLeft][0].centre_px, s.survey.views[0].seen[kLeft][0].centre_px);
  ASSERT_TRUE(again.views[0].seen[kLeft][0].ellipse);
  EXPECT_EQ(again.views[0].seen[kLeft][0].ellipse->minor_px, 30);
}

TEST(SurveyJson, OtherResolution_IsRefused) {
  const test::SyntheticSurvey s = test::make_survey(1, 0.1, 2);
  std::string text = to_survey_json(s.survey, s.rig);
  text.replace(text.find("1280"), 4, "1920");
  EXPECT_TRUE(contains(refusal([&] { parse_survey_json("s.json", text, s.rig); }), "is not the calibration's"));
}

TEST(SurveyJson, Damage_IsRefusedWithTheName) {
  const StereoRig rig = test::make_stereo_rig();
  for (const char* text : {"", "{", "[]", "{\"format\": 3}", "{\"format\": \"roomcal-survey-1\"}"}) {
    EXPECT_TRUE(contains(refusal([&] { parse_survey_json("s.json", text, rig); }), "s.json")) << text;
  }
}

}  // namespace
}  // namespace roomcal::tools
