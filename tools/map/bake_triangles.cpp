#include "tools/map/bake_triangles.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "runtime/base/arena.h"
#include "runtime/math/so3.h"
#include "runtime/pose/image_triangles.h"
#include "tools/common/error.h"
#include "tools/common/random.h"

namespace roomcal::tools {
namespace {

uint64_t key_of(map::MarkerTriple t) {
  // The smallest number first, the turning sense kept: the same triangle seen from its other side is another one.
  while (t[0] > t[1] || t[0] > t[2]) t = {t[1], t[2], t[0]};
  return (static_cast<uint64_t>(t[0]) << 32U) | (static_cast<uint64_t>(t[1]) << 16U) | t[2];
}

map::MarkerTriple triple_of(uint64_t key) {
  return {static_cast<uint16_t>(key >> 32U), static_cast<uint16_t>(key >> 16U), static_cast<uint16_t>(key)};
}

bool is_seen(const map::MapMarker& marker, const Vec3& camera_room, const BakeTrianglesOptions& options) {
  const Vec3 to_camera = camera_room - marker.p_room;
  const double range_m = to_camera.norm();
  if (range_m < options.min_range_m || range_m > options.max_range_m) return false;
  if (marker.normal_room.squaredNorm() < 0.25) return true;
  return marker.normal_room.dot(to_camera) > std::cos(options.max_slant_rad) * range_m;
}

/// One look around from a random place, turned at random.
class Viewer {
 public:
  Viewer(std::span<const map::MapMarker> markers, const BakeTrianglesOptions& options)
      : markers_(markers), options_(options), random_(options.seed), low_(markers[0].p_room), high_(low_) {
    for (const map::MapMarker& m : markers) {
      low_ = low_.cwiseMin(m.p_room);
      high_ = high_.cwiseMax(m.p_room);
    }
    // A map of one wall has no depth: cameras then stand in front of it (those behind it see nothing).
    const Vec3 missing = (Vec3::Constant((high_ - low_).maxCoeff()) - (high_ - low_)) / 2.0;
    const Vec3 margin = (missing.array() > 0.4 * (high_ - low_).maxCoeff()).select(missing, Vec3::Zero());
    low_ -= margin;
    high_ += margin;
  }

  void look() {
    const Vec3 part(random_.uniform(), random_.uniform(), random_.uniform());
    // Devices do not touch the walls: the middle 80 % of the box.
    const Vec3 camera_room = low_ + (high_ - low_).cwiseProduct((0.1 + 0.8 * part.array()).matrix());
    const Mat33 R_cam_room = so3_exp(kPi * Vec3(random_.uniform(), random_.uniform(), random_.uniform()));
    bearings_.clear();
    numbers_.clear();
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      const bool missed = random_.uniform() < options_.miss_probability;
      if (missed || !is_seen(markers_[i], camera_room, options_)) continue;
      bearings_.push_back(R_cam_room * (markers_[i].p_room - camera_room).normalized());
      numbers_.push_back(static_cast<uint16_t>(i));
    }
  }

  std::span<const Vec3> bearings() const { return bearings_; }
  map::MarkerTriple numbers(const pose::Triple& t) const { return {numbers_[t[0]], numbers_[t[1]], numbers_[t[2]]}; }

 private:
  std::span<const map::MapMarker> markers_;
  const BakeTrianglesOptions& options_;
  Random random_;
  Vec3 low_;
  Vec3 high_;
  std::vector<Vec3> bearings_;
  std::vector<uint16_t> numbers_;
};

}  // namespace

std::vector<map::MarkerTriple> bake_triangles(std::span<const map::MapMarker> markers,
                                              const BakeTrianglesOptions& options) {
  if (markers.size() < 3) return {};
  if (markers.size() > 65532) throw ToolError("triangle index: more than 65532 markers: split the map");
  std::vector<std::byte> bytes(pose::image_triangles_bytes(markers.size()));
  Arena arena(bytes);
  Viewer viewer(markers, options);
  std::unordered_map<uint64_t, std::size_t> count;
  for (std::size_t view = 0; view < options.views; ++view) {
    viewer.look();
    Arena::Scope scope(arena);
    std::span<pose::Triple> triangles;
    require(pose::image_triangles(viewer.bearings(), {}, arena, triangles), "triangle index");
    for (const pose::Triple& triangle : triangles) ++count[key_of(viewer.numbers(triangle))];
  }
  std::vector<std::pair<uint64_t, std::size_t>> ranked(count.begin(), count.end());
  std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  ranked.resize(std::min({ranked.size(), options.max_triples_per_marker * markers.size(), std::size_t{65535}}));
  std::vector<map::MarkerTriple> triples;
  triples.reserve(ranked.size());
  for (const auto& [key, seen] : ranked) triples.push_back(triple_of(key));
  return triples;
}

}  // namespace roomcal::tools
