#include "tools/report/report_page.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tests/tools/report/sample_result.h"
#include "tools/common/files.h"
#include "tools/evaluate/scene_map.h"
#include "tools/map/map_builder.h"
#include "tools/simulate/make_room.h"

namespace roomcal::tools {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;
using test::contains;
using test::refusal;
using test::sample_places;
using test::sample_result;

class ReportPageTest : public test::FolderTest {
 protected:
  fs::path written(const json& result) const {
    write_atomic(path("result.json"), result.dump());
    return path("result.json");
  }
};

/// What the page was given, back from it.
json data_of(const std::string& html) {
  const std::string begin = R"(<script type="application/json" id="data">)";
  const std::size_t from = html.find(begin) + begin.size();
  return json::parse(html.substr(from, html.find("</script>", from) - from));
}

TEST_F(ReportPageTest, ResultAlone_MakesAPageThatSaysWhatItIs) {
  const ReportPage page = report_page({written(sample_result(sample_places())), {}, {}, {}, {}});
  EXPECT_TRUE(contains(page.html, "<title>Calibration of sample</title>"));
  const json data = data_of(page.html);
  EXPECT_EQ(data.at("result").at("verdict"), "PASS");
  EXPECT_EQ(data.at("source"), "result.json");
  EXPECT_EQ(data.at("outlines").at("cam1").size(), 32U);
  for (const char* part : {"room", "pictures", "sweeps", "installed", "truth"}) EXPECT_FALSE(data.contains(part));
}

TEST_F(ReportPageTest, NothingIsLoadedFromAnywhere) {
  const ReportPage page = report_page({written(sample_result(sample_places())), {}, {}, {}, {}});
  for (const char* part : {" src=", "@import", "url(", "fetch(", "XMLHttpRequest", "https://"})
    EXPECT_FALSE(contains(page.html, part)) << part;
}

TEST_F(ReportPageTest, MapOfTheResult_BringsItsRoomAndAnotherOneIsRefused) {
  RoomOptions options;
  options.seed = 1;
  const LoadedMap map = open_map(map_data_of(make_room(options)));
  write_atomic(path("a.room"), map.bytes.span());
  json result = sample_result(sample_places());
  result["map"]["hash"] = fmt::format("{:08x}", map.map.content_crc32c());
  const ReportPage page = report_page({written(result), {}, path("a.room"), {}, {}});
  EXPECT_EQ(data_of(page.html).at("room").at("markers").size(), map.map.marker_count());
  result["map"]["hash"] = "00000001";
  EXPECT_TRUE(contains(refusal([&] {
                         report_page({written(result), {}, path("a.room"), {}, {}});
                       }),
                       "another map than the result's"));
}

TEST_F(ReportPageTest, WhatAShotLacks_IsNotedAndTheRestIsShown) {
  fs::create_directories(path("shot"));
  cv::imwrite(file("shot/cam0.png"), cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)));
  const ReportPage page = report_page({written(sample_result(sample_places())), path("shot"), {}, {}, {}});
  EXPECT_EQ(page.notes.size(), 2U);  // no image of cam1 and cam2
  const json data = data_of(page.html);
  EXPECT_EQ(data.at("notes").size(), 2U);
  EXPECT_TRUE(data.at("pictures").contains("cam0"));
  EXPECT_FALSE(data.at("pictures").contains("cam1"));
}

}  // namespace
}  // namespace roomcal::tools
