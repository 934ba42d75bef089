#include "runtime/lidar/calibration.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::lidar {
namespace {

std::vector<Beam> beams(std::size_t count) {
  std::vector<Beam> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i].elevation_rad = 0.01 * static_cast<double>(i);
  return result;
}

TEST(MakeCalibration, WrongTables_AreRefused) {
  EXPECT_TRUE(make_calibration(Model::kXt16, beams(16)).ok());
  EXPECT_EQ(make_calibration(Model::kXt16, beams(15)).status().code(), StatusCode::kInvalidArgument);
  std::vector<Beam> bad = beams(16);
  bad[3].elevation_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(make_calibration(Model::kXt16, bad).ok());
  bad = beams(16);
  bad[3].range_offset_m = 5;
  EXPECT_FALSE(make_calibration(Model::kXt16, bad).ok());
  EXPECT_FALSE(make_calibration(Model::kXt16, std::vector<Beam>(16)).ok()) << "a flat cloud";
}

TEST(MakeCalibration, AbsurdOusterFormats_AreRefused) {
  EXPECT_TRUE(make_calibration(OusterFormat{}, beams(32)).ok());
  EXPECT_FALSE(make_calibration(OusterFormat{.columns_per_packet = 0}, beams(32)).ok());
  EXPECT_FALSE(make_calibration(OusterFormat{.columns_per_frame = 5000}, beams(32)).ok());
  EXPECT_FALSE(make_calibration(OusterFormat{.last_column = 1024}, beams(32)).ok());
  EXPECT_FALSE(make_calibration(OusterFormat{.beam_origin_m = 27}, beams(32)).ok()) << "millimetres";
}

TEST(BuiltInCalibration, ManualsTables_HaveTheirCorners) {
  const Calibration vlp16 = built_in_calibration(Model::kVlp16).value();
  EXPECT_NEAR(rad_to_deg(vlp16.beams[0].elevation_rad), -15, 1e-9);
  EXPECT_NEAR(rad_to_deg(vlp16.beams[15].elevation_rad), 15, 1e-9);
  const Calibration hdl32e = built_in_calibration(Model::kHdl32e).value();
  EXPECT_NEAR(rad_to_deg(hdl32e.beams[0].elevation_rad), -30.67, 0.01);
  EXPECT_NEAR(rad_to_deg(hdl32e.beams[31].elevation_rad), 10.67, 0.01);
  const Calibration vlp32c = built_in_calibration(Model::kVlp32c).value();
  EXPECT_NEAR(rad_to_deg(vlp32c.beams[29].elevation_rad), 15, 1e-9);
  EXPECT_NEAR(rad_to_deg(vlp32c.beams[1].azimuth_offset_rad), -4.2, 1e-9);
  EXPECT_EQ(built_in_calibration(Model::kQt128).status().code(), StatusCode::kNotFound);
}

TEST(FindModel, NamesAsPeopleWriteThem_AreFound) {
  for (const ModelInfo& model : known_models()) EXPECT_EQ(find_model(model.name), &info(model.model));
  EXPECT_EQ(find_model("VLP-16")->model, Model::kVlp16);
  EXPECT_EQ(find_model("PandarXT-32")->model, Model::kXt32);
  EXPECT_EQ(find_model("OS1")->model, Model::kOuster);
  EXPECT_EQ(find_model("vlp1"), nullptr);
  EXPECT_EQ(find_model(""), nullptr);
}

TEST(WindowColumns, AcrossColumnZero_Wraps) {
  EXPECT_EQ(window_columns(OusterFormat{}), 1024U);
  EXPECT_EQ(window_columns(OusterFormat{.first_column = 1000, .last_column = 23}), 48U);
}

}  // namespace
}  // namespace roomcal::lidar
