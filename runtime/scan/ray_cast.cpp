#include "runtime/scan/ray_cast.h"

#include <cmath>

#include "runtime/base/vector_clones.h"

// Compiled as vector code, see CMakeLists.txt.
namespace roomcal::scan {

namespace {

constexpr double kTouching_m = 1e-4;  // a plane this near is not seen
constexpr double kEdge_m = 1e-4;      // neighbours share an edge: no ray slips between them

/// A linear form of directions and its bounds over a block's box.
struct Form {
  float x, y, z;
};
struct Bounds {
  float low, high;
};
Bounds bounds_of(const Form& form, const RayBlock& block) {
  const float middle = form.x * block.middle[0] + form.y * block.middle[1] + form.z * block.middle[2];
  const float reach =
      std::abs(form.x) * block.reach[0] + std::abs(form.y) * block.reach[1] + std::abs(form.z) * block.reach[2];
  return {middle - reach, middle + reach};
}

void evaluate(const Form& form, const RayBlock& block, BlockFloats& value) {
  for (std::size_t i = 0; i < kBlockRays; ++i)
    value[i] = form.x * block.x[i] + form.y * block.y[i] + form.z * block.z[i];
}

/// value = min(value, form . d).
void narrow(const Form& form, const RayBlock& block, BlockFloats& value) {
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const float at = form.x * block.x[i] + form.y * block.y[i] + form.z * block.z[i];
    value[i] = at < value[i] ? at : value[i];
  }
}

void keep_nearer(int32_t face, const BlockFloats& inverse_m, const BlockFloats& inside, BlockHits& hits) {
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const float met = inverse_m[i], before = hits.inverse_m[i];
    const int32_t face_before = hits.face[i];
    const float candidate = inside[i] > 0 ? met : 0;
    hits.inverse_m[i] = candidate > before ? met : before;
    hits.face[i] = candidate > before ? face : face_before;
  }
}

void clear(BlockHits& hits) {
  hits.inverse_m.fill(0);
  hits.face.fill(kNoFace);
}

}  // namespace

void PosedSurface::set(const Surface& surface, const SE3& T_room_lidar) {
  count_ = surface.faces().size();
  const Mat33 R_lidar_room = T_room_lidar.R.transpose();
  std::size_t edge = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Face& face = surface.faces()[i];
    const double height_m = face.normal_room.dot(T_room_lidar.t) + face.d_m;
    const bool touching = std::abs(height_m) < kTouching_m;
    const Vec3 g = touching ? Vec3(Vec3::Zero()) : Vec3(R_lidar_room * face.normal_room / -height_m);
    height_m_[i] = touching ? 0 : static_cast<float>(height_m);
    gx_[i] = static_cast<float>(g.x());
    gy_[i] = static_cast<float>(g.y());
    gz_[i] = static_cast<float>(g.z());
    first_edge_[i] = static_cast<uint16_t>(edge);
    for (const FaceEdge& of : surface.edges(face)) {
      const double inside_m = of.inward_room.dot(T_room_lidar.t) + of.d_m + kEdge_m;
      const Vec3 e = R_lidar_room * of.inward_room + inside_m * g;
      ex_[edge] = static_cast<float>(e.x());
      ey_[edge] = static_cast<float>(e.y());
      ez_[edge] = static_cast<float>(e.z());
      ++edge;
    }
  }
  first_edge_[count_] = static_cast<uint16_t>(edge);
  gx_[kNoFace] = gy_[kNoFace] = gz_[kNoFace] = height_m_[kNoFace] = 0;
}

ROOMCAL_VECTOR_CLONES void PosedSurface::cast(const RayBlock& block, BlockHits& hits) const {
  alignas(64) BlockFloats inverse_m, inside;
  clear(hits);
  for (std::size_t i = 0; i < count_; ++i) {
    const Form plane{gx_[i], gy_[i], gz_[i]};
    if (!(bounds_of(plane, block).high > 0)) continue;
    std::array<Form, kMaxFaceEdges> cutting;
    std::size_t cuts = 0;
    bool reached = true;
    for (std::size_t k = first_edge_[i]; k < first_edge_[i + 1] && reached; ++k) {
      const Form edge{ex_[k], ey_[k], ez_[k]};
      const Bounds bounds = bounds_of(edge, block);
      reached = bounds.high > 0;
      if (bounds.low <= 0) cutting[cuts++] = edge;
    }
    if (!reached) continue;
    evaluate(plane, block, inverse_m);
    inside = inverse_m;
    for (std::size_t k = 0; k < cuts; ++k) narrow(cutting[k], block, inside);
    keep_nearer(static_cast<int32_t>(i), inverse_m, inside, hits);
  }
}

ROOMCAL_VECTOR_CLONES void PosedSurface::cast_behind(const RayBlock& block, const BlockHits& first,
                                                     BlockHits& behind) const {
  alignas(64) BlockFloats inverse_m;
  clear(behind);
  for (std::size_t i = 0; i < count_; ++i) {
    const Form plane{gx_[i], gy_[i], gz_[i]};
    if (!(height_m_[i] > 0) || !(bounds_of(plane, block).high > 0)) continue;
    evaluate(plane, block, inverse_m);
    const auto face = static_cast<int32_t>(i);
    for (std::size_t k = 0; k < kBlockRays; ++k) {
      const float met = inverse_m[k], before = behind.inverse_m[k];
      const int32_t face_before = behind.face[k];
      const float farther = met <= first.inverse_m[k] ? met : 0;
      const float candidate = first.face[k] != face ? farther : 0;
      behind.inverse_m[k] = candidate > before ? met : before;
      behind.face[k] = candidate > before ? face : face_before;
    }
  }
}

}  // namespace roomcal::scan
