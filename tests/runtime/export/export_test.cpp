#include "runtime/export/export.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/export/frames.h"
#include "runtime/export/summary.h"
#include "tests/runtime/store/sample_record.h"

namespace roomcal::exports {
namespace {

using store::test::sample_record;

constexpr std::array<Format, 7> kAll{Format::kJson,    Format::kKalibr,   Format::kUrdf,  Format::kRosTf,
                                     Format::kRosInfo, Format::kAutoware, Format::kOpenCv};

TEST(Export, Names_GoBothWays) {
  for (const Format format : kAll) EXPECT_EQ(parse_format(to_string(format)).value(), format);
  EXPECT_EQ(parse_format("pdf").status().code(), StatusCode::kNotFound);
}

TEST(Export, EveryShortBuffer_IsCapacityAndNeverOverrun) {
  const store::Record record = sample_record(1, 2, 1);
  for (const Format format : kAll) {
    std::vector<char> whole(32768);
    TextWriter out(whole);
    ASSERT_TRUE(write(record, format, "cam1", out).ok());
    const std::size_t size = out.view().size();
    for (std::size_t cut = 0; cut < size; cut += 1 + size / 97) {
      std::vector<char> small(cut);
      TextWriter cut_out(small);
      EXPECT_EQ(write(record, format, "cam1", cut_out).code(), StatusCode::kCapacity);
    }
  }
}

TEST(Export, LargestRecord_FitsInTheStatedSize) {
  const store::Record record = store::test::largest_record();
  std::vector<char> buffer(24 * 1024);
  for (const Format format : kAll) {
    TextWriter out(buffer);
    EXPECT_TRUE(write(record, format, record.sensors[3].name.view(), out).ok()) << to_string(format);
  }
}

TEST(Export, NoCamera_IsNotFoundWhereOneIsNeeded) {
  const store::Record record = sample_record(1, 0, 2);
  std::vector<char> buffer(32768);
  for (const Format format : kAll) {
    TextWriter out(buffer);
    const bool needs_camera = format == Format::kKalibr || format == Format::kOpenCv || format == Format::kRosInfo;
    EXPECT_EQ(write(record, format, "lidar0", out).code(), needs_camera ? StatusCode::kNotFound : StatusCode::kOk);
  }
}

TEST(Export, ReferenceAlone_StillHasAWorkedPoint) {
  const store::Record record = sample_record(1, 1);
  std::vector<char> buffer(32768);
  for (const Format format : kAll) {
    TextWriter out(buffer);
    ASSERT_TRUE(write(record, format, "cam0", out).ok());
    EXPECT_NE(out.view().find("worked"), std::string_view::npos) << to_string(format);
  }
}

TEST(Export, NameWithDoubleHyphen_DoesNotEndAnXmlComment) {
  store::Record record = sample_record(1, 2);
  record.sensors[1].name = "cam--front-";
  std::vector<char> buffer(32768);
  TextWriter out(buffer);
  ASSERT_TRUE(write(record, Format::kUrdf, {}, out).ok());
  EXPECT_NE(out.view().find("in cam-_front- is"), std::string_view::npos);
}

TEST(RollPitchYaw, AnyRotation_ComesBack) {
  for (double roll = -3; roll <= 3; roll += 0.5)
    for (const double pitch : {-kPi / 2, -kPi / 2 + 1e-9, -1.0, 0.0, 0.3, kPi / 2 - 1e-7, kPi / 2})
      for (double yaw = -3; yaw <= 3; yaw += 0.5) {
        const auto compose = [](const Vec3& rpy) -> Mat33 {
          return so3_exp({0, 0, rpy.z()}) * so3_exp({0, rpy.y(), 0}) * so3_exp({rpy.x(), 0, 0});
        };
        const Mat33 R = compose({roll, pitch, yaw});
        EXPECT_LT((compose(roll_pitch_yaw(R)) - R).cwiseAbs().maxCoeff(), 1e-12) << roll << " " << pitch << " " << yaw;
      }
}

TEST(Summary, RecordAndDiff_NameEverySensor) {
  const store::Record a = sample_record(1, 2, 1);
  store::Record b = a;
  b.sensors[1].T_rig_sensor.t.x() += 0.005;
  std::vector<char> buffer(8192);
  TextWriter out(buffer);
  write_summary(a, out);
  for (const char* word : {"cam0", "cam1", "lidar0", "9 markers only", "hall 3", "robot-7"})
    EXPECT_NE(out.view().find(word), std::string_view::npos) << word;
  out.clear();
  write_summary(store::diff(a, b), out);
  EXPECT_NE(out.view().find("moved 5.000 mm"), std::string_view::npos) << out.view();
  EXPECT_NE(out.view().find("beyond chance"), std::string_view::npos);
}

}  // namespace
}  // namespace roomcal::exports
