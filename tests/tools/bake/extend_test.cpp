#include "tools/bake/extend.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/tools/bake/synthetic_survey.h"
#include "tests/tools/refusal.h"
#include "tools/map/compare.h"
#include "tools/map/complete_map.h"

namespace roomcal::tools {
namespace {

/// A map of the room's truth in a frame of its own, ids from 100.
MapData old_map(const std::vector<truth::RoomMarker>& room, const SE3& T_old_room) {
  MapData data;
  data.id = "old";
  for (std::size_t i = 0; i < room.size(); ++i) {
    map::MapMarker marker;
    marker.id = static_cast<uint32_t>(100 + i);
    marker.p_room = T_old_room * room[i].p_room;
    marker.normal_room = T_old_room.R * room[i].normal_room;
    marker.has_normal = true;
    marker.cov_m2 = 1e-6 * Mat33::Identity();
    data.markers.push_back(marker);
  }
  complete_map(data);
  return data;
}

/// A room before and after somebody worked in it, and the survey of how it is now.
struct ChangedRoom {
  MapData old;
  SE3 T_old_room;
  std::vector<truth::RoomMarker> now;
  BakeResult fresh;
};

constexpr std::size_t kMoved = 3, kGone = 7;

/// Marker kMoved moves by 12 cm, kGone falls off, one more is pasted beside the place of marker 20.
ChangedRoom change_room(uint64_t seed) {
  truth::Random random(seed);
  ChangedRoom room;
  std::vector<truth::RoomMarker> before = truth::make_room(random, 180);
  room.T_old_room = {so3_exp({0, 0, 0.7}), Vec3(1, -2, 0)};
  room.old = old_map(before, room.T_old_room);
  room.now = before;
  const Vec3 along = before[kMoved].normal_room.unitOrthogonal();
  room.now[kMoved].p_room += 0.12 * along;
  room.now.push_back({0.5 * (before[20].p_room + before[21].p_room), before[20].normal_room});
  room.now.erase(room.now.begin() + kGone);
  const test::SyntheticSurvey s = test::walk_through(room.now, seed, 0.05, 18);
  room.fresh = bake(s.survey, s.rig, {});
  return room;
}

class Extend : public testing::Test {
 protected:
  static void SetUpTestSuite() { room_ = new ChangedRoom(change_room(5)); }
  static void TearDownTestSuite() { delete room_; }
  static ChangedRoom* room_;
};
ChangedRoom* Extend::room_ = nullptr;

TEST_F(Extend, ChangedRoom_SaysWhatChanged) {
  MapChanges changes;
  extend_map(room_->old, room_->fresh, {}, changes);
  ASSERT_EQ(changes.moved.size(), 1U);
  EXPECT_EQ(changes.moved[0].id, 100 + kMoved);
  EXPECT_NEAR((changes.moved[0].to_room - changes.moved[0].from_room).norm(), 0.12, 0.002);
  // Walks see most of a room, not all: what fell off is vanished, or not looked at, but never "same".
  for (const uint32_t id : changes.vanished) EXPECT_EQ(id, 100 + kGone);
  EXPECT_EQ(std::count(changes.vanished.begin(), changes.vanished.end(), 100 + kGone) +
                std::count(changes.unseen.begin(), changes.unseen.end(), 100 + kGone),
            1);
  EXPECT_LE(changes.added.size(), 1U);
  for (const uint32_t id : changes.added) EXPECT_EQ(id, 280U);
  EXPECT_NEAR(changes.scale, 1, 5e-4);
  EXPECT_LT(changes.same_rms_m, 0.002);
}

TEST_F(Extend, NewMap_KeepsFrameIdsAndWhatWasNotSeen) {
  MapChanges changes;
  const MapData extended = extend_map(room_->old, room_->fresh, {}, changes);
  EXPECT_EQ(extended.id, "old");
  EXPECT_EQ(extended.markers.size(),
            changes.same + changes.moved.size() + changes.added.size() + changes.unseen.size());
  EXPECT_TRUE(std::is_sorted(extended.markers.begin(), extended.markers.end(),
                             [](const auto& a, const auto& b) { return a.id < b.id; }));
  for (const map::MapMarker& marker : extended.markers) {
    double nearest_m = 1;
    for (const truth::RoomMarker& truth : room_->now)
      nearest_m = std::min(nearest_m, (room_->T_old_room * truth.p_room - marker.p_room).norm());
    const bool kept = std::count(changes.unseen.begin(), changes.unseen.end(), marker.id) > 0;
    EXPECT_TRUE(kept || nearest_m < 0.003) << marker.id << " " << nearest_m;
  }
  EXPECT_FALSE(extended.triangles.empty());
}

TEST_F(Extend, SameMarkers_BecomeMoreCertain) {
  MapChanges changes;
  const MapData extended = extend_map(room_->old, room_->fresh, {}, changes);
  std::size_t better = 0;
  for (const map::MapMarker& marker : extended.markers) better += marker.cov_m2.trace() < 3e-6 - 1e-9;
  EXPECT_GE(better, changes.same);
}

TEST_F(Extend, AnotherRoom_IsRefused) {
  truth::Random random(77);
  const MapData other = old_map(truth::make_room(random, 180), {});
  MapChanges changes;
  EXPECT_TRUE(test::contains(test::refusal([&] { extend_map(other, room_->fresh, {}, changes); }), "another room"));
}

TEST_F(Extend, Json_HasWhatTheTextSays) {
  MapChanges changes;
  extend_map(room_->old, room_->fresh, {}, changes);
  const auto json = changes_json(changes);
  EXPECT_EQ(json["same"], changes.same);
  EXPECT_NEAR(json["moved"][0]["distance_mm"].get<double>(), 120, 2);
  EXPECT_TRUE(test::contains(changes_text(changes), "moved: marker 103"));
}

}  // namespace
}  // namespace roomcal::tools
