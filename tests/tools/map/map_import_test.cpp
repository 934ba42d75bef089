#include "tools/map/map_import.h"

#include <gtest/gtest.h>

#include "runtime/map/format.h"
#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

std::string refusal_of(const std::string& text) {
  return refusal([&] { static_cast<void>(parse_map_text("m.csv", text)); });
}

TEST(ParseMapCsv, AllColumns_AreRead) {
  const MapData data = parse_map_csv("m.csv", "id,x,y,z,nx,ny,nz,radius\n7,1.5,-2,3e-1,0,0.6,0.8,0.085\n");
  ASSERT_EQ(data.markers.size(), 1U);
  const map::MapMarker& marker = data.markers[0];
  EXPECT_EQ(marker.id, 7U);
  EXPECT_EQ(marker.p_room, Vec3(1.5, -2, 0.3));
  EXPECT_TRUE(marker.has_normal && marker.has_radius && !marker.normal_estimated);
  EXPECT_LT((marker.normal_room - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(marker.radius_m, 0.085);
  EXPECT_EQ(marker.cov_m2, Mat33::Zero());
}

TEST(ParseMapCsv, OtherOrderSpacesCommentsAndWindowsLines_AreRead) {
  const MapData data =
      parse_map_csv("m.csv", "\xEF\xBB\xBF# survey\r\nradius, z ,y,x,id\r\n\r\n , 3,2,1,0\r\n0.1,6,5,4,1\r\n");
  ASSERT_EQ(data.markers.size(), 2U);
  EXPECT_EQ(data.markers[0].p_room, Vec3(1, 2, 3));
  EXPECT_FALSE(data.markers[0].has_radius);
  EXPECT_TRUE(data.markers[1].has_radius);
  EXPECT_FALSE(data.markers[1].has_normal);
}

TEST(ParseMapCsv, WithoutHeader_TheCountOfColumnsDecides) {
  EXPECT_EQ(parse_map_csv("m.csv", "1,1,2,3").markers[0].p_room, Vec3(1, 2, 3));
  EXPECT_EQ(parse_map_csv("m.csv", "1,1,2,3,0.1\n").markers[0].radius_m, 0.1);
  EXPECT_TRUE(parse_map_csv("m.csv", "1,1,2,3,0,0,1\n").markers[0].has_normal);
  EXPECT_EQ(parse_map_csv("m.csv", "1,1,2,3,0,0,1,0.2\n").markers[0].radius_m, 0.2);
}

struct Bad {
  const char* text;
  const char* expected;
};

TEST(ParseMapCsv, EveryBadInput_NamesFileLineAndField) {
  for (const Bad& bad : std::vector<Bad>{
           {"", "m.csv: no marker"},
           {"\n\n", "m.csv: no marker"},
           {"id,x,y,z\n", "m.csv: no marker"},
           {"id,x,y\n1,2,3\n", "m.csv:1: column `z` is missing"},
           {"id,x,y,z,nx\n1,1,2,3,1\n", "m.csv:1: of nx,ny,nz some are missing"},
           {"id,x,y,z,foo\n", "m.csv:1: unknown column `foo`"},
           {"id,x,y,z,x\n", "m.csv:1: column `x` stands twice"},
           {"1,2,3\n", "m.csv:1: 3 columns and no header"},
           {"1,2,3,4,5,6\n", "m.csv:1: 6 columns and no header"},
           {"id,x,y,z\n1,1,2,3\n2,1,2\n", "m.csv:3: 3 columns, the lines before have 4"},
           {"id,x,y,z\n1,nan,2,3\n", "m.csv:2: x: `nan` is not a finite number"},
           {"id,x,y,z\n1,1,inf,3\n", "m.csv:2: y: `inf`"},
           {"id,x,y,z\n1,1,2,\n", "m.csv:2: z: `` is not a finite number"},
           {"id,x,y,z\n1,1,2,3m\n", "m.csv:2: z: `3m`"},
           {"id,x,y,z\n1,1,2,1e5\n", "m.csv:2: position: beyond 10000 m"},
           {"id,x,y,z\n-1,1,2,3\n", "m.csv:2: id: `-1`"},
           {"id,x,y,z\n1.5,1,2,3\n", "m.csv:2: id: `1.5`"},
           {"id,x,y,z\n4294967296,1,2,3\n", "m.csv:2: id: `4294967296`"},
           {"id,x,y,z\n1,1,2,3\n1,4,5,6\n", "m.csv:3: id: 1 stands already on line 2"},
           {"id,x,y,z,radius\n1,1,2,3,-0.1\n", "m.csv:2: radius: -0.1"},
           {"id,x,y,z,radius\n1,1,2,3,0\n", "m.csv:2: radius: 0"},
           {"id,x,y,z,radius\n1,1,2,3,nan\n", "m.csv:2: radius: `nan`"},
           {"id,x,y,z,nx,ny,nz\n1,1,2,3,0,0,2\n", "m.csv:2: nx,ny,nz: length 2"},
           {"id,x,y,z,nx,ny,nz\n1,1,2,3,0,0,0\n", "m.csv:2: nx,ny,nz: length 0"},
           {"id,x,y,z,nx,ny,nz\n1,1,2,3,0,,1\n", "m.csv:2: ny: ``"},
           {"\x7F\x45LF\x01\x02", "m.csv:1:"},
       }) {
    EXPECT_TRUE(contains(refusal_of(bad.text), bad.expected)) << bad.text << "\ngot: " << refusal_of(bad.text);
  }
}

TEST(ParseMapCsv, MoreMarkersThanAMapHolds_AreRefused) {
  std::string text;
  for (std::size_t i = 0; i <= map::kMaxMarkers; ++i) text += std::to_string(i) + ",1,2,3\n";
  EXPECT_TRUE(contains(refusal_of(text), "m.csv:4097: more than 4096 markers"));
}

TEST(ParseMapYaml, PapersForm_IsReadAndTheRestPassedOver) {
  const MapData data = parse_map_text("m.yaml",
                                      "MapPoints:\n"
                                      "  12:\n    position: [0.5, -1, 2]\n    projections: [[0, 1], [3, 4]]\n"
                                      "  3:\n    position: [1, 2, 3]\n"
                                      "FramePoses:\n  0:\n    pose: [nan]\n");
  ASSERT_EQ(data.markers.size(), 2U);
  EXPECT_EQ(data.markers[0].id, 12U);
  EXPECT_EQ(data.markers[0].p_room, Vec3(0.5, -1, 2));
  EXPECT_FALSE(data.markers[0].has_normal || data.markers[0].has_radius);
}

TEST(ParseMapYaml, EveryBadInput_NamesFileLineAndField) {
  for (const Bad& bad : std::vector<Bad>{
           {"MapPoints:\n", "`MapPoints` is missing"},
           {"MapPoints: {}\n", "m.csv:1: `MapPoints` holds no marker"},
           {"MapPoints: 3\n", "m.csv:1: `MapPoints` holds no marker"},
           {"MapPoints:\n  1: 5\n", "m.csv:2: "},
           {"MapPoints:\n  1:\n    where: [1, 2, 3]\n", "`position` is missing"},
           {"MapPoints:\n  1:\n    position: [1, 2]\n", "m.csv:3: marker 1: position: expected a list of 3"},
           {"MapPoints:\n  1:\n    position: [1, .nan, 2]\n", "m.csv:3: marker 1: position: expected a finite number"},
           {"MapPoints:\n  1:\n    position: [1, 1e9, 2]\n", "m.csv:2: position: beyond"},
           {"MapPoints:\n  a:\n    position: [1, 2, 3]\n", "m.csv:2: id: `a`"},
           {"MapPoints:\n  1:\n    position: [1, 2, 3]\n  1:\n    position: [1, 2, 3]\n",
            "m.csv:4: id: 1 stands already"},
           {"MapPoints:\n  1: [\n", "m.csv:"},
       }) {
    EXPECT_TRUE(contains(refusal_of(bad.text), bad.expected)) << bad.text << "\ngot: " << refusal_of(bad.text);
  }
}

}  // namespace
}  // namespace roomcal::tools
