#include "tools/report/compare_poses.h"

#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tests/tools/report/sample_result.h"
#include "tools/common/files.h"

namespace roomcal::tools {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;
using test::contains;
using test::refusal;
using test::sample_places;
using test::sample_result;

class ComparePoses : public test::FolderTest {
 protected:
  ResultFile result(const std::vector<SE3>& places, const std::string& rig_frame = "cam0") const {
    json written = sample_result(places);
    written["rig_frame"] = rig_frame;
    const std::size_t reference = static_cast<std::size_t>(rig_frame.back() - '0');
    for (std::size_t i = 0; i < places.size(); ++i)
      written["sensors"]["cam" + std::to_string(i)]["T_rig_sensor"] =
          rows_of((places[reference].inverse() * places[i]).matrix());
    write_atomic(path("r.json"), written.dump());
    return read_result(path("r.json"));
  }
  fs::path truth(const std::vector<SE3>& places) const {
    json out;
    for (std::size_t i = 0; i < places.size(); ++i)
      out["T_room_sensor"]["cam" + std::to_string(i)]["T"] = rows_of(places[i].matrix());
    write_atomic(path("truth.json"), out.dump());
    return path("truth.json");
  }
};

Vec6 delta_of(const json& changes, const std::string& sensor) {
  return Vec6(changes.at(sensor).at("delta").get<std::vector<double>>().data());
}

/// cam1 shifted by 1 mm along its own z and turned by 2 mrad about its own x.
Vec6 shift() {
  Vec6 xi = Vec6::Zero();
  xi[2] = 1e-3;
  xi[3] = 2e-3;
  return xi;
}
std::vector<SE3> moved_places() {
  std::vector<SE3> places = sample_places();
  places[1] = places[1] * se3_exp(shift());
  return places;
}

TEST_F(ComparePoses, MovedSensor_IsOffByThatInItsOwnFrameAndNoOther) {
  const json changes = against_installed(result(moved_places()), result(sample_places()));
  EXPECT_FALSE(changes.contains("cam0"));
  EXPECT_LT((delta_of(changes, "cam1") - shift()).norm(), 1e-12);
  EXPECT_LT(delta_of(changes, "cam2").norm(), 1e-12);
  EXPECT_LT(changes.at("cam1").at("p_value").get<double>(), 1e-6);
  EXPECT_NEAR(changes.at("cam2").at("p_value").get<double>(), 1, 1e-9);
  EXPECT_NEAR(changes.at("cam2").at("covariance")[0][0].get<double>(), 2e-8, 1e-12);  // both
}

TEST_F(ComparePoses, InstalledInAnotherRigFrame_IsCarriedOver) {
  const json changes = against_installed(result(moved_places()), result(sample_places(), "cam2"));
  EXPECT_LT((delta_of(changes, "cam1") - shift()).norm(), 1e-12);
  EXPECT_LT(delta_of(changes, "cam2").norm(), 1e-12);
}

TEST_F(ComparePoses, SensorThatOnlyOneKnows_IsNotComparable) {
  const std::vector<SE3> all = sample_places();
  const json changes = against_installed(result(all), result({all[0], all[1]}));
  EXPECT_TRUE(changes.at("cam1").at("comparable"));
  EXPECT_FALSE(changes.at("cam2").at("comparable"));
}

TEST_F(ComparePoses, Truth_IsWhatTheEstimateMustBeMovedBy) {
  const json errors = against_truth(result(sample_places()), truth(moved_places()));
  EXPECT_LT((delta_of(errors, "cam1") - shift()).norm(), 1e-12);
  EXPECT_LT(delta_of(errors, "cam2").norm(), 1e-12);
  EXPECT_EQ(errors.at("cam1").at("covariance")[0][0], 1e-8);
}

TEST_F(ComparePoses, TruthOfAnotherDeviceOrNone_IsRefusedByName) {
  const ResultFile now = result(sample_places());
  EXPECT_TRUE(contains(refusal([&] { against_truth(now, truth({SE3()})); }), "truth.json: says nothing of cam1"));
  write_atomic(path("no.json"), "{}");
  EXPECT_TRUE(contains(refusal([&] { against_truth(now, path("no.json")); }), "no.json: is not the truth"));
  EXPECT_TRUE(contains(refusal([&] { against_truth(now, path("none.json")); }), "none.json"));
}

}  // namespace
}  // namespace roomcal::tools
