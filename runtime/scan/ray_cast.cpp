#include "runtime/scan/ray_cast.h"

#include <limits>

namespace roomcal::scan {

namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr float kTouching_m = 1e-4F;  // nothing is nearer
constexpr std::size_t kLanes = 8;     // the loop over planes runs in whole vectors
constexpr double kEdge_m = 1e-4;      // neighbours share an edge: no ray slips between them

}  // namespace

void PosedSurface::set(const Surface& surface, const SE3& T_room_lidar) {
  surface_ = &surface;
  T_room_lidar_ = T_room_lidar;
  count_ = surface.faces().size();
  padded_ = (count_ + kLanes - 1) / kLanes * kLanes;
  for (std::size_t i = 0; i < count_; ++i) {
    const Face& face = surface.faces()[i];
    const Vec3 n = T_room_lidar.R.transpose() * face.normal_room;
    const double h = face.normal_room.dot(T_room_lidar.t) + face.d_m;
    normal_lidar_[i] = n;
    height_m_[i] = h;
    nx_[i] = static_cast<float>(n.x());
    ny_[i] = static_cast<float>(n.y());
    nz_[i] = static_cast<float>(n.z());
    h_[i] = static_cast<float>(h);
  }
  for (std::size_t i = count_; i < padded_; ++i) {
    nx_[i] = ny_[i] = nz_[i] = 0;
    h_[i] = 0;
  }
}

void PosedSurface::plane_ranges(const Vec3& direction_lidar, Ranges& range_m) const {
  const float x = static_cast<float>(direction_lidar.x());
  const float y = static_cast<float>(direction_lidar.y());
  const float z = static_cast<float>(direction_lidar.z());
  for (std::size_t i = 0; i < padded_; ++i) {
    const float speed = nx_[i] * x + ny_[i] * y + nz_[i] * z;
    const float range = -h_[i] / speed;  // infinite or not a number along the plane, negative away from it
    range_m[i] = range > kTouching_m ? range : kNever;
  }
}

bool PosedSurface::inside_outline(int face, const Vec3& p_lidar) const {
  const Vec3 p_room = T_room_lidar_ * p_lidar;
  for (const FaceEdge& edge : surface_->edges(surface_->faces()[static_cast<std::size_t>(face)])) {
    if (edge.inward_room.dot(p_room) + edge.d_m < -kEdge_m) return false;
  }
  return true;
}

double PosedSurface::exact_range_m(int face, const Vec3& direction_lidar) const {
  const auto i = static_cast<std::size_t>(face);
  return -height_m_[i] / normal_lidar_[i].dot(direction_lidar);
}

int PosedSurface::nearest(const Vec3& direction_lidar, Ranges& range_m) const {
  for (;;) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < count_; ++i) best = range_m[i] < range_m[best] ? i : best;
    if (count_ == 0 || range_m[best] == kNever) return kNoFace;
    const int face = static_cast<int>(best);
    if (inside_outline(face, static_cast<double>(range_m[best]) * direction_lidar)) return face;
    range_m[best] = kNever;
  }
}

RayHit PosedSurface::first_hit(const Vec3& direction_lidar) const {
  Ranges range_m;
  plane_ranges(direction_lidar, range_m);
  const int face = nearest(direction_lidar, range_m);
  if (face == kNoFace) return {};
  if (height_m_[static_cast<std::size_t>(face)] < 0) return {kNoFace, 0, true};
  return {face, exact_range_m(face, direction_lidar), false};
}

RayHits PosedSurface::first_two_hits(const Vec3& direction_lidar) const {
  RayHits hits;
  hits.first = first_hit(direction_lidar);
  if (hits.first.face == kNoFace) return hits;
  Ranges range_m;
  plane_ranges(direction_lidar, range_m);
  const auto behind_m = static_cast<float>(hits.first.range_m);
  float nearest_m = kNever;
  for (std::size_t i = 0; i < count_; ++i) {
    if (static_cast<int>(i) == hits.first.face || height_m_[i] < 0) continue;
    if (range_m[i] < behind_m || range_m[i] >= nearest_m) continue;
    nearest_m = range_m[i];
    hits.second.face = static_cast<int>(i);
  }
  if (hits.second.face != kNoFace) hits.second.range_m = exact_range_m(hits.second.face, direction_lidar);
  return hits;
}

}  // namespace roomcal::scan
