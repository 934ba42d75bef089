#include "runtime/map/check.h"

#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/map/small_map.h"
#include "tools/common/error.h"

namespace roomcal::map {
namespace {

using tools::MapData;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Damage {
  const char* expected;  ///< words of the reason
  std::function<void(MapData&)> apply;
};

/// What RoomMap::open() says about a map built with this damage; the builder shows its own work to open().
std::string reason_for(const Damage& damage) {
  MapData data = test::small_map();
  damage.apply(data);
  try {
    static_cast<void>(tools::build_map(data));
  } catch (const tools::ToolError& error) {
    return error.what();
  }
  return "";
}

const std::vector<Damage>& damages() {
  static const std::vector<Damage> kDamages{
      {"no marker", [](MapData& d) { d.markers.clear(), d.triangles.clear(); }},
      {"position is not finite", [](MapData& d) { d.markers[1].p_room.y() = kNan; }},
      {"position is not finite", [](MapData& d) { d.markers[1].p_room.y() = HUGE_VAL; }},
      {"beyond 10 km", [](MapData& d) { d.markers[1].p_room.z() = -2e4; }},
      {"covariance is not finite", [](MapData& d) { d.markers[2].cov_m2(0, 0) = kNan; }},
      {"not positive semi-definite", [](MapData& d) { d.markers[2].cov_m2(1, 1) = -1e-6; }},
      {"not positive semi-definite", [](MapData& d) { d.markers[2].cov_m2(0, 1) = d.markers[2].cov_m2(1, 0) = 5e-6; }},
      {"normal is not finite or not of unit", [](MapData& d) { d.markers[0].normal_room *= 1.01; }},
      {"normal is not finite or not of unit", [](MapData& d) { d.markers[0].normal_room.x() = kNan; }},
      {"normal is not finite or not of unit", [](MapData& d) { d.markers[0].normal_room.setZero(); }},
      {"radius is not finite, not positive", [](MapData& d) { d.markers[0].radius_m = -0.085; }},
      {"radius is not finite, not positive", [](MapData& d) { d.markers[0].radius_m = 0; }},
      {"radius is not finite, not positive", [](MapData& d) { d.markers[0].radius_m = kNan; }},
      {"radius is not finite, not positive or beyond", [](MapData& d) { d.markers[0].radius_m = 11; }},
      {"ids do not ascend", [](MapData& d) { d.markers[1].id = d.markers[0].id; }},
      {"ids do not ascend", [](MapData& d) { std::swap(d.markers[1].id, d.markers[2].id); }},
      {"plane that is not in the map", [](MapData& d) { d.markers[1].plane = 3; }},
      {"plane's normal is not of unit", [](MapData& d) { d.planes[1].plane.normal_room *= 0.9; }},
      {"plane's distance is not finite", [](MapData& d) { d.planes[1].plane.d_m = kNan; }},
      {"plane's distance is not finite", [](MapData& d) { d.planes[1].plane.rms_m = -1; }},
      {"plane's covariance is not finite", [](MapData& d) { d.planes[0].plane.cov(0, 0) = kNan; }},
      {"plane's covariance is not finite or not positive", [](MapData& d) { d.planes[0].plane.cov(1, 1) = -1e-6; }},
      {"outline is not finite", [](MapData& d) { d.planes[0].outline_room[1].x() = kNan; }},
      {"outline has too many", [](MapData& d) { d.planes[0].outline_room.assign(kMaxOutline + 1, Vec3::Zero()); }},
      {"more than 256 planes", [](MapData& d) { d.planes.resize(kMaxPlanes + 1); }},
      {"triangle names a marker that is not", [](MapData& d) { d.triangles[1][2] = 5; }},
      {"triangle names a marker twice",
       [](MapData& d) {
         d.triangles[1] = {3, 1, 3};
       }},
      {"more triangles",
       [](MapData& d) {
         d.triangles.assign(kMaxTriangles + 1, {0, 1, 2});
       }},
      {"line's planes do not ascend", [](MapData& d) { std::swap(d.lines[0].plane_a, d.lines[0].plane_b); }},
      {"line's planes do not ascend", [](MapData& d) { d.lines[0].plane_b = 0; }},
      {"line does not lie on two planes", [](MapData& d) { d.lines[0].plane_b = 3; }},
      {"line does not lie on two planes", [](MapData& d) { d.lines[0].to_room.z() = 0.02; }},
      {"line does not lie on two planes", [](MapData& d) { d.lines[1].from_room.x() = kNan; }},
      {"more lines", [](MapData& d) { d.lines.assign(kMaxLines + 1, d.lines[0]); }},
      {"corner's planes do not ascend", [](MapData& d) { std::swap(d.corners[0].planes[0], d.corners[0].planes[2]); }},
      {"corner does not lie on three planes", [](MapData& d) { d.corners[0].planes[2] = 3; }},
      {"corner does not lie on three planes", [](MapData& d) { d.corners[0].p_room.y() += 0.02; }},
      {"corner does not lie on three planes", [](MapData& d) { d.corners[0].p_room.y() = kNan; }},
      {"more corners", [](MapData& d) { d.corners.assign(kMaxCorners + 1, d.corners[0]); }},
      {"surface spacing", [](MapData& d) { d.surface_spacing_m = kNan; }},
      {"surface spacing", [](MapData& d) { d.surface_spacing_m = -0.05; }},
      {"surface spacing", [](MapData& d) { d.surface_spacing_m = 1e-5; }},
      {"do not descend from 1", [](MapData& d) { d.ring_ratios[0] = 0.9F; }},
      {"do not descend from 1", [](MapData& d) { d.ring_ratios[2] = d.ring_ratios[1]; }},
      {"do not descend from 1", [](MapData& d) { d.ring_ratios[5] = 0; }},
      {"do not descend from 1", [](MapData& d) { d.ring_ratios[3] = std::numeric_limits<float>::quiet_NaN(); }},
      {"more ring edges", [](MapData& d) { d.ring_ratios.assign(kMaxRingEdges + 1, 1.0F); }},
      {"4096", [](MapData& d) { d.markers.resize(kMaxMarkers + 1); }},
  };
  return kDamages;
}

TEST(CheckContent, EveryDamage_IsRefusedWithItsReason) {
  for (const Damage& damage : damages()) {
    EXPECT_NE(reason_for(damage).find(damage.expected), std::string::npos)
        << "expected: " << damage.expected << "\ngot: " << reason_for(damage);
  }
}

TEST(CheckContent, NoDamage_IsAccepted) {
  EXPECT_EQ(reason_for({"", [](MapData&) {}}), "");
}

// Covariances that are only just semi-definite, as rank-deficient ones rounded to floats are.
TEST(CheckContent, RankDeficientCovariance_IsAccepted) {
  const Vec3 axis = Vec3(1, 2, 3).normalized();
  for (const double sigma_m : {1e-5, 1e-3, 1e-1}) {
    const Damage rank_one{"", [&](MapData& d) { d.markers[0].cov_m2 = sigma_m * sigma_m * axis * axis.transpose(); }};
    EXPECT_EQ(reason_for(rank_one), "") << sigma_m;
  }
}

TEST(CheckContent, MostMarkersAllowed_IsAccepted) {
  MapData data;
  data.markers.resize(kMaxMarkers);
  for (std::size_t i = 0; i < data.markers.size(); ++i) data.markers[i].id = static_cast<uint32_t>(i);
  EXPECT_NO_THROW(static_cast<void>(tools::build_map(data)));
}

TEST(CheckHeader, EveryKindOfDamage_HasItsOwnReason) {
  const tools::AlignedBytes whole = tools::build_map(test::small_map());
  std::set<std::string> reasons;
  const auto note = [&](std::span<const std::byte> bytes) {
    FileHeader header{};
    std::span<const std::byte> payload;
    const Status status = check_header(bytes, header, payload);
    EXPECT_FALSE(status.ok());
    EXPECT_TRUE(reasons.insert(status.detail()).second) << status.detail();
  };
  const auto flipped = [&](std::size_t offset) {
    tools::AlignedBytes bytes = test::resized(whole, whole.span().size());
    bytes.span()[offset] ^= std::byte{1};
    return bytes;
  };
  note(whole.span().first(3));
  note(whole.span().first(20));
  note(whole.span().first(100));
  note(test::resized(whole, whole.span().size() + 8).span());
  note(flipped(0).span());
  note(flipped(offsetof(FileHeader, version)).span());
  note(flipped(offsetof(FileHeader, created_unix_s)).span());
  note(flipped(200).span());
}

TEST(CheckStructure, PayloadTooSmallForFlatBuffers_IsRefused) {
  alignas(8) const std::array<std::byte, 16> bytes{};
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    EXPECT_EQ(check_structure(std::span(bytes).first(size)), nullptr) << size;
  }
}

}  // namespace
}  // namespace roomcal::map
