#include "tools/sweep/cloud_files.h"

#include <cmath>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

lidar::Bytes view(const std::string& text) { return std::as_bytes(std::span<const char>(text)); }

std::string floats(std::initializer_list<float> values, bool big = false) {
  std::string out;
  for (const float value : values) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    if (big) std::swap(raw[0], raw[3]), std::swap(raw[1], raw[2]);
    out.append(raw, 4);
  }
  return out;
}

const std::string kPcdHead =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
    "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";

void expect_two_points(const std::string& file) {
  const LoadedSweep sweep = read_cloud("c", view(file));
  ASSERT_EQ(sweep.points.size(), 2U);
  EXPECT_EQ(sweep.points[0].x_m, 1.0F);
  EXPECT_EQ(sweep.points[0].reflectivity, 7);
  EXPECT_EQ(sweep.points[1].z_m, -6.5F);
  EXPECT_NEAR(static_cast<double>(sweep.points[0].range_m), std::sqrt(14.0), 1e-6);
}

TEST(ReadCloud, PcdOfEveryKind_GivesTheSamePoints) {
  expect_two_points(kPcdHead + "ascii\n1 2 3 7\n4 5 -6.5 8\n");
  expect_two_points(kPcdHead + "binary\n" + floats({1, 2, 3, 7, 4, 5, -6.5F, 8}));
  // Field after field; literal runs of at most 32 bytes are valid LZF.
  const std::string plain = floats({1, 4, 2, 5, 3, -6.5F, 7, 8});
  std::string packed = std::string(1, '\x1F') + plain;
  std::string sizes(8, '\0');
  sizes[0] = static_cast<char>(packed.size());
  sizes[4] = static_cast<char>(plain.size());
  expect_two_points(kPcdHead + "binary_compressed\n" + sizes + packed);
}

TEST(ReadCloud, PlyOfEveryKind_GivesTheSamePoints) {
  const auto head = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment made by hand\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
           "property float intensity\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
  };
  expect_two_points(head("ascii") + "1 2 3 7\n4 5 -6.5 8\n");
  expect_two_points(head("binary_little_endian") + floats({1, 2, 3, 7, 4, 5, -6.5F, 8}));
  expect_two_points(head("binary_big_endian") + floats({1, 2, 3, 7, 4, 5, -6.5F, 8}, true));
}

TEST(ReadCloud, PointsThatAreNone_AreLeftOut) {
  const LoadedSweep sweep = read_cloud("c", view(kPcdHead + "ascii\nnan nan nan 0\n0 0 1 8\n"));
  EXPECT_EQ(sweep.points.size(), 1U);
}

TEST(ReadCloud, BadFiles_NameFileAndFault) {
  const auto says = [](const std::string& file, const std::string& part) {
    const std::string got = refusal([&] { static_cast<void>(read_cloud("c.pcd", view(file))); });
    EXPECT_TRUE(contains(got, "c.pcd") && contains(got, part)) << "wanted: " << part << ", got: " << got;
  };
  says(kPcdHead + "binary\n" + floats({1, 2, 3}), "ends after 0 of 2 points");
  says(kPcdHead + "ascii\n1 2 3 7\n4 5", "ends before its last point");
  says(kPcdHead + "ascii\n1 2 three 7\n", "expected a number");
  says(kPcdHead + "zip\n", "DATA zip is not read");
  says(kPcdHead, "no DATA line");
  says("# .PCD\nFIELDS x\nSIZE 3\n", "SIZE 3 is not understood");
  says("# .PCD\nFIELDS x\nSIZE 4 4\n", "different lengths");
  says("# .PCD\nFIELDS x\nWIDTH -1\n", "whole number");
  says("# .PCD\nFIELDS a\nWIDTH 1\nDATA ascii\n1\n", "no fields x, y, z");
  says(kPcdHead + "ascii\n0 0 0 0\n0 0 0 0\n", "holds no point");
  says(kPcdHead + "binary_compressed\n" + std::string("\xFF\0\0\0\xFF\xFF\xFF\x7F", 8), "shorter than it says");
  says("ply\nformat ascii 1.0\nelement face 1\nend_header\n", "before the vertices");
  says("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n", "not read for vertices");
  says("ply\nformat ascii 1.0\nelement vertex 2\n", "no end_header");
}

TEST(LzfDecompress, ReferencesThatOverlapThemselves_Repeat) {
  // "ab", then 6 bytes from 2 back: abababab.
  const std::string packed = std::string(
                                 "\x01"
                                 "ab",
                                 3) +
                             std::string("\x80\x01", 2);
  std::vector<std::byte> out(8);
  ASSERT_TRUE(lzf_decompress(view(packed), out));
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(out.data()), 8), "abababab");
  EXPECT_FALSE(lzf_decompress(view(std::string("\x80\x05", 2)), out)) << "before the beginning";
  EXPECT_FALSE(lzf_decompress(view(packed.substr(0, 4)), out)) << "cut";
}

TEST(WritePcd, ReadAgain_IsTheSame) {
  std::vector<LoadedSweep> sweeps(2);
  lidar::SweepPoint point;
  point.x_m = 1.5F;
  point.y_m = -2;
  point.z_m = 0.25F;
  point.offset_ns = 1234567;
  point.beam = 7;
  point.reflectivity = 300;
  point.return_index = 1;
  sweeps[0].points = {point, point};
  sweeps[1].points = {point};
  const LoadedSweep again = read_cloud("again", write_pcd(sweeps));
  ASSERT_EQ(again.points.size(), 3U);
  EXPECT_EQ(again.facts.beam_count, 8);
  for (const lidar::SweepPoint& p : again.points) {
    EXPECT_EQ(p.y_m, -2.0F);
    EXPECT_EQ(p.offset_ns, 1234567);
    EXPECT_EQ(p.beam, 7);
    EXPECT_EQ(p.reflectivity, 300);
    EXPECT_EQ(p.return_index, 1);
  }
}

}  // namespace
}  // namespace roomcal::tools
