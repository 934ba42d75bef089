#include "tools/bake/extend.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <fmt/format.h>

#include "tools/align/rigid_fit.h"
#include "tools/common/error.h"
#include "tools/map/compare.h"
#include "tools/map/complete_map.h"

namespace roomcal::tools {

using nlohmann::ordered_json;

namespace {

using map::MapMarker;
using Pair = std::pair<std::size_t, std::size_t>;  // numbers in the old and the fresh map

class MapExtender {
 public:
  MapExtender(const MapData& old, const BakeResult& fresh, const ExtendOptions& options, MapChanges& changes)
      : old_(old),
        fresh_(fresh),
        options_(options),
        changes_(changes),
        in_fresh_(old.markers.size(), kNone),
        in_old_(fresh.data.markers.size(), kNone) {}

  MapData run() {
    align();
    pair_same();
    MapData out;
    out.id = old_.id;
    out.ring_ratios = old_.ring_ratios;
    take_old(out);
    take_fresh(out);
    complete_map(out);
    return out;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  Vec3 to_old(const Vec3& p_fresh) const { return T_old_fresh_ * Vec3(changes_.scale * p_fresh); }
  Vec3 to_fresh(const Vec3& p_old) const { return T_old_fresh_.inverse() * p_old / changes_.scale; }

  /// Least squares over what agrees, the gate narrowing: moved markers must not pull.
  void align() {
    const auto comparison = compare_maps(old_, fresh_.data);
    if (!comparison) throw ToolError("the survey and the map to extend have no place in common: another room?");
    T_old_fresh_ = comparison->T_a_b;
    std::vector<Pair> pairs = comparison->matched;
    for (const double gate_m : {0.05, 0.02, 0.01, options_.same_m, options_.same_m}) {
      fit(pairs);
      std::vector<Pair> again;
      for (const auto& [i, j] : comparison->matched) {
        if (distance_m(i, j) < std::max(gate_m, 3 * median_distance_m(pairs))) again.emplace_back(i, j);
      }
      if (again.size() < 4) break;
      pairs = std::move(again);
    }
    fit(pairs);
  }

  void fit(const std::vector<Pair>& pairs) {
    std::vector<Vec3> p_old, p_fresh;
    for (const auto& [i, j] : pairs) {
      p_old.push_back(old_.markers[i].p_room);
      p_fresh.push_back(fresh_.data.markers[j].p_room);
    }
    changes_.scale = fit_scale(p_old, p_fresh, fit_rigid(p_old, p_fresh));
    for (Vec3& p : p_fresh) p *= changes_.scale;
    T_old_fresh_ = fit_rigid(p_old, p_fresh);
  }

  double distance_m(std::size_t i, std::size_t j) const {
    return (old_.markers[i].p_room - to_old(fresh_.data.markers[j].p_room)).norm();
  }

  double median_distance_m(const std::vector<Pair>& pairs) const {
    std::vector<double> d_m;
    for (const auto& [i, j] : pairs) d_m.push_back(distance_m(i, j));
    const auto middle = d_m.begin() + static_cast<std::ptrdiff_t>(d_m.size() / 2);
    std::nth_element(d_m.begin(), middle, d_m.end());
    return *middle;
  }

  Mat33 cov_in_old(const MapMarker& fresh) const {
    const Mat33& R = T_old_fresh_.R;
    return changes_.scale * changes_.scale * R * fresh.cov_m2 * R.transpose();
  }

  /// Nearest first, each once, as long as they are where they were.
  void pair_same() {
    std::vector<std::pair<double, Pair>> near;
    for (std::size_t i = 0; i < old_.markers.size(); ++i) {
      for (std::size_t j = 0; j < fresh_.data.markers.size(); ++j) {
        const double sigma_m = std::sqrt(old_.markers[i].cov_m2.trace() + cov_in_old(fresh_.data.markers[j]).trace());
        if (const double d_m = distance_m(i, j); d_m < std::max(options_.same_m, 4 * sigma_m))
          near.push_back({d_m, {i, j}});
      }
    }
    double sum2 = 0;
    for (const auto& [d_m, pair] : pair_up(near)) {
      sum2 += d_m * d_m;
      ++changes_.same;
    }
    changes_.same_rms_m = std::sqrt(sum2 / static_cast<double>(std::max<std::size_t>(1, changes_.same)));
  }

  std::vector<std::pair<double, Pair>> pair_up(std::vector<std::pair<double, Pair>>& near) {
    std::sort(near.begin(), near.end());
    std::vector<std::pair<double, Pair>> taken;
    for (const auto& candidate : near) {
      const auto& [i, j] = candidate.second;
      if (in_fresh_[i] != kNone || in_old_[j] != kNone) continue;
      in_fresh_[i] = j;
      in_old_[j] = i;
      taken.push_back(candidate);
    }
    return taken;
  }

  void take_old(MapData& out) {
    std::vector<std::pair<double, Pair>> near;
    std::vector<bool> gone(old_.markers.size(), false);
    for (std::size_t i = 0; i < old_.markers.size(); ++i) {
      if (in_fresh_[i] != kNone) {
        out.markers.push_back(
            fused(old_.markers[i], moved_over(fresh_.data.markers[in_fresh_[i]], old_.markers[i].id)));
        continue;
      }
      gone[i] = is_covered(i) || count_looks(old_.markers[i]) >= options_.looks;
      if (!gone[i]) {
        changes_.unseen.push_back(old_.markers[i].id);
        out.markers.push_back(old_.markers[i]);
        continue;
      }
      for (std::size_t j = 0; j < in_old_.size(); ++j) {
        if (in_old_[j] == kNone && distance_m(i, j) < options_.moved_m) near.push_back({distance_m(i, j), {i, j}});
      }
    }
    for (const auto& [d_m, pair] : pair_up(near)) {
      const auto& [i, j] = pair;
      out.markers.push_back(moved_over(fresh_.data.markers[j], old_.markers[i].id));
      changes_.moved.push_back({old_.markers[i].id, old_.markers[i].p_room, out.markers.back().p_room});
    }
    for (std::size_t i = 0; i < gone.size(); ++i) {
      if (gone[i] && in_fresh_[i] == kNone) changes_.vanished.push_back(old_.markers[i].id);
    }
    std::sort(changes_.moved.begin(), changes_.moved.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  }

  bool is_covered(std::size_t i) const {
    for (std::size_t j = 0; j < in_old_.size(); ++j) {
      if (in_old_[j] == kNone && distance_m(i, j) < options_.overlap_m) return true;
    }
    return false;
  }

  void take_fresh(MapData& out) {
    uint32_t next = 0;
    for (const MapMarker& marker : old_.markers) next = std::max(next, marker.id + 1);
    for (std::size_t j = 0; j < in_old_.size(); ++j) {
      if (in_old_[j] != kNone) continue;
      out.markers.push_back(moved_over(fresh_.data.markers[j], next));
      changes_.added.push_back(next++);
    }
  }

  MapMarker moved_over(MapMarker marker, uint32_t id) const {
    marker.id = id;
    marker.cov_m2 = cov_in_old(marker);
    marker.p_room = to_old(marker.p_room);
    marker.normal_room = T_old_fresh_.R * marker.normal_room;
    marker.radius_m *= changes_.scale;
    // Normals that only came from the old planes are found anew; so is the plane.
    if (marker.normal_estimated) marker.normal_room.setZero(), marker.has_normal = marker.normal_estimated = false;
    return marker;
  }

  /// Both places weighed; a map that claims to be exact keeps its place.
  static MapMarker fused(const MapMarker& old, const MapMarker& fresh) {
    MapMarker out = old;
    if (!old.has_normal && fresh.has_normal) {
      out.normal_room = fresh.normal_room;
      out.has_normal = true;
    }
    if (!old.has_radius && fresh.has_radius) {
      out.radius_m = fresh.radius_m;
      out.has_radius = true;
    }
    if (old.cov_m2.trace() <= 0 || fresh.cov_m2.trace() <= 0) return out;
    const Mat33 gain = old.cov_m2 * Mat33(old.cov_m2 + fresh.cov_m2).inverse();
    out.p_room = old.p_room + gain * (fresh.p_room - old.p_room);
    const Mat33 cov_m2 = old.cov_m2 - gain * old.cov_m2;
    out.cov_m2 = 0.5 * (cov_m2 + cov_m2.transpose());
    return out;
  }

  /// Views of the survey that should have shown a marker, had it been there.
  std::size_t count_looks(const MapMarker& marker) const {
    const Reconstruction& map = fresh_.map;
    const Vec3 p_fresh = to_fresh(marker.p_room);
    const Vec3 normal_fresh = T_old_fresh_.R.transpose() * marker.normal_room;
    const double margin_px = 0.08 * map.rig.cameras[kLeft].intrinsics().width_px;
    constexpr double kMaxRange_m = 3.5;
    std::size_t looks = 0;
    for (const std::size_t v : map.order) {
      const SE3& T_room_left = map.views[v].T_room_left;
      const Vec3 to_camera = T_room_left.t - p_fresh;
      Vec2 px;
      if (to_camera.norm() > kMaxRange_m) continue;
      if (marker.has_normal && normal_fresh.dot(to_camera) < std::cos(options_.max_slant_rad) * to_camera.norm())
        continue;
      if (!map.rig.project(kLeft, T_room_left.inverse() * p_fresh, px).ok() || !map.rig.in_image(kLeft, px, margin_px))
        continue;
      ++looks;
    }
    return looks;
  }

  const MapData& old_;
  const BakeResult& fresh_;
  const ExtendOptions& options_;
  MapChanges& changes_;
  SE3 T_old_fresh_;
  std::vector<std::size_t> in_fresh_, in_old_;  ///< partner in the other map, or kNone
};

ordered_json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

std::string list_ids(const std::vector<uint32_t>& ids) {
  constexpr std::size_t kNamed = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, ids.size()); ++i) text += fmt::format("{}{}", i > 0 ? ", " : "", ids[i]);
  return ids.size() > kNamed ? text + " ..." : text;
}

}  // namespace

MapData extend_map(const MapData& old, const BakeResult& fresh, const ExtendOptions& options, MapChanges& changes) {
  changes = {};
  return MapExtender(old, fresh, options, changes).run();
}

ordered_json changes_json(const MapChanges& changes) {
  ordered_json moved = ordered_json::array();
  for (const MovedMarker& m : changes.moved) {
    moved.push_back({{"id", m.id},
                     {"distance_mm", 1e3 * (m.to_room - m.from_room).norm()},
                     {"from", vector_json(m.from_room)},
                     {"to", vector_json(m.to_room)}});
  }
  return {{"same", changes.same},         {"same_rms_mm", 1e3 * changes.same_rms_m},
          {"scale", changes.scale},       {"moved", moved},
          {"vanished", changes.vanished}, {"added", changes.added},
          {"unseen", changes.unseen}};
}

std::string changes_text(const MapChanges& changes) {
  std::string text = fmt::format(
      "{} markers are where they were ({:.2f} mm RMS), {} moved, {} vanished, {} are new, {} not "
      "looked at\n",
      changes.same, 1e3 * changes.same_rms_m, changes.moved.size(), changes.vanished.size(), changes.added.size(),
      changes.unseen.size());
  for (const MovedMarker& m : changes.moved) {
    text += fmt::format("moved: marker {} by {:.1f} mm to ({:.3f}, {:.3f}, {:.3f})\n", m.id,
                        1e3 * (m.to_room - m.from_room).norm(), m.to_room.x(), m.to_room.y(), m.to_room.z());
  }
  if (!changes.vanished.empty()) text += "vanished: " + list_ids(changes.vanished) + "\n";
  if (!changes.added.empty()) text += "new: " + list_ids(changes.added) + "\n";
  if (!changes.unseen.empty()) text += "not looked at, kept as they were: " + list_ids(changes.unseen) + "\n";
  return text;
}

}  // namespace roomcal::tools
