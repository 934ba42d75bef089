#include "runtime/map/check.h"

#include <cmath>
#include <cstring>

#include <Eigen/Eigenvalues>

#include "runtime/base/crc32c.h"
#include "runtime/map/room_generated.h"
#include "runtime/math/types.h"

namespace roomcal::map {

namespace {

constexpr double kUnitTolerance = 1e-6;       // of markers' normals, stored as floats: rounding leaves 1e-7
constexpr double kPlaneUnitTolerance = 1e-9;  // of planes' normals, stored as doubles
constexpr double kPsdTolerance = 1e-5;        // of the largest eigenvalue: rounding of the stored floats, with room
constexpr uint16_t kKnownFlags = kHasNormal | kHasRadius | kNormalEstimated;

constexpr Status corrupt(const char* detail) { return {StatusCode::kCorrupt, detail}; }

bool is_unit(const Vec3& v, double tolerance) { return v.allFinite() && std::abs(v.norm() - 1) < tolerance; }
bool is_coordinate(double x_m) { return std::abs(x_m) <= kMaxCoordinate_m; }  // false for NaN as well

template <typename T>
std::size_t size_of(const flatbuffers::Vector<T>* vector) {
  return vector == nullptr ? 0 : vector->size();
}

// The verifier looks at a vector's length field only; elements with 8-byte members may still lie askew.
template <typename T>
bool is_aligned(const flatbuffers::Vector<T>* vector, std::size_t alignment) {
  return size_of(vector) == 0 || reinterpret_cast<uintptr_t>(vector->Data()) % alignment == 0;
}

bool is_positive_semi_definite(const fbs::Cov3f& c) {
  Mat33 cov;
  cov << c.xx(), c.xy(), c.xz(), c.xy(), c.yy(), c.yz(), c.xz(), c.yz(), c.zz();
  if (!cov.allFinite() || cov.cwiseAbs().maxCoeff() > kMaxCoordinate_m) return false;
  const Eigen::SelfAdjointEigenSolver<Mat33> solver(cov, Eigen::EigenvaluesOnly);
  return solver.info() == Eigen::Success && solver.eigenvalues()[0] >= -kPsdTolerance * solver.eigenvalues()[2];
}

Status check_marker(const fbs::Marker& marker, std::size_t planes) {
  const fbs::Vec3d& p = marker.p_room();
  if (!is_coordinate(p.x()) || !is_coordinate(p.y()) || !is_coordinate(p.z())) {
    return corrupt("a marker's position is not finite or beyond 10 km; bake the map again");
  }
  if (!is_positive_semi_definite(marker.cov_m2())) {
    return corrupt("a marker's covariance is not finite or not positive semi-definite; bake the map again");
  }
  if ((marker.flags() & ~kKnownFlags) != 0) return corrupt("a marker has unknown flags; bake the map again");
  const fbs::Vec3f& n = marker.normal_room();
  const Vec3 normal(n.x(), n.y(), n.z());
  const bool has_normal = (marker.flags() & kHasNormal) != 0;
  if (has_normal ? !is_unit(normal, kUnitTolerance) : normal != Vec3::Zero()) {
    return corrupt("a marker's normal is not finite or not of unit length; bake the map again");
  }
  const bool has_radius = (marker.flags() & kHasRadius) != 0;
  const double radius_m = marker.radius_m();
  if (has_radius ? !(radius_m > 0 && radius_m <= kMaxRadius_m) : radius_m != 0) {
    return corrupt("a marker's radius is not finite, not positive or beyond 10 m; bake the map again");
  }
  if (marker.plane() != kNoPlane && marker.plane() >= planes) {
    return corrupt("a marker names a plane that is not in the map; bake the map again");
  }
  return ok_status();
}

Status check_plane(const fbs::Plane& plane) {
  const fbs::Vec3d& n = *plane.normal_room();
  if (!is_unit({n.x(), n.y(), n.z()}, kPlaneUnitTolerance))
    return corrupt("a plane's normal is not of unit length; bake the map again");
  if (!is_coordinate(plane.d_m()) || !(plane.rms_m() >= 0 && is_coordinate(plane.rms_m()))) {
    return corrupt("a plane's distance is not finite; bake the map again");
  }
  if (plane.cov() != nullptr && !is_positive_semi_definite(*plane.cov()))
    return corrupt("a plane's covariance is not finite or not positive semi-definite; bake the map again");
  if (size_of(plane.outline_room()) > kMaxOutline) return corrupt("a plane's outline has too many vertices");
  for (std::size_t i = 0; i < size_of(plane.outline_room()); ++i) {
    const fbs::Vec3f& v = *plane.outline_room()->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (!is_coordinate(v.x()) || !is_coordinate(v.y()) || !is_coordinate(v.z())) {
      return corrupt("a plane's outline is not finite; bake the map again");
    }
  }
  return ok_status();
}

Status check_triangles(const flatbuffers::Vector<const fbs::Triangle*>* triangles, std::size_t markers) {
  if (size_of(triangles) > kMaxTriangles) return corrupt("more triangles than a map may have");
  for (std::size_t i = 0; i < size_of(triangles); ++i) {
    const fbs::Triangle& t = *triangles->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (t.a() >= markers || t.b() >= markers || t.c() >= markers) {
      return corrupt("a triangle names a marker that is not in the map; bake the map again");
    }
    if (t.a() == t.b() || t.b() == t.c() || t.a() == t.c()) {
      return corrupt("a triangle names a marker twice; bake the map again");
    }
  }
  return ok_status();
}

bool is_on_plane(const fbs::RoomMap& content, std::size_t plane, const fbs::Vec3f& p) {
  if (plane >= size_of(content.planes())) return false;
  if (!is_coordinate(p.x()) || !is_coordinate(p.y()) || !is_coordinate(p.z())) return false;
  const fbs::Plane& stored = *content.planes()->Get(static_cast<flatbuffers::uoffset_t>(plane));
  const fbs::Vec3d& n = *stored.normal_room();
  return std::abs(n.x() * p.x() + n.y() * p.y() + n.z() * p.z() + stored.d_m()) <= kMaxOffPlane_m;
}

Status check_lines(const fbs::RoomMap& content) {
  if (size_of(content.lines()) > kMaxLines) return corrupt("more lines than a map may have");
  for (std::size_t i = 0; i < size_of(content.lines()); ++i) {
    const fbs::Line& line = *content.lines()->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (line.plane_a() >= line.plane_b()) return corrupt("a line's planes do not ascend; bake the map again");
    for (const uint16_t plane : {line.plane_a(), line.plane_b()}) {
      if (!is_on_plane(content, plane, line.from_room()) || !is_on_plane(content, plane, line.to_room())) {
        return corrupt("a line does not lie on two planes of the map; bake the map again");
      }
    }
  }
  return ok_status();
}

Status check_corners(const fbs::RoomMap& content) {
  if (size_of(content.corners()) > kMaxCorners) return corrupt("more corners than a map may have");
  for (std::size_t i = 0; i < size_of(content.corners()); ++i) {
    const fbs::Corner& corner = *content.corners()->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (corner.plane_a() >= corner.plane_b() || corner.plane_b() >= corner.plane_c() || corner.pad() != 0) {
      return corrupt("a corner's planes do not ascend; bake the map again");
    }
    for (const uint16_t plane : {corner.plane_a(), corner.plane_b(), corner.plane_c()}) {
      if (!is_on_plane(content, plane, corner.p_room())) {
        return corrupt("a corner does not lie on three planes of the map; bake the map again");
      }
    }
  }
  return ok_status();
}

Status check_spacing(float spacing_m) {
  const bool fits = spacing_m == 0 || (spacing_m >= kMinSpacing_m && spacing_m <= kMaxSpacing_m);
  return fits ? ok_status() : corrupt("the surface spacing is not finite or out of range; bake the map again");
}

Status check_ring_ratios(const flatbuffers::Vector<float>* ratios) {
  if (size_of(ratios) > kMaxRingEdges) return corrupt("more ring edges than a marker may have");
  for (std::size_t i = 0; i < size_of(ratios); ++i) {
    const auto at = static_cast<flatbuffers::uoffset_t>(i);
    const bool in_order = i == 0 ? ratios->Get(at) == 1.0F : ratios->Get(at) < ratios->Get(at - 1);
    if (!in_order || !(ratios->Get(at) > 0))
      return corrupt("the ring ratios do not descend from 1; bake the map again");
  }
  return ok_status();
}

bool is_layout_sound(const fbs::RoomMap& content) {
  bool sound = is_aligned(content.markers(), alignof(fbs::Marker));
  sound = sound && is_aligned(content.triangles(), alignof(fbs::Triangle));
  sound = sound && is_aligned(content.lines(), alignof(fbs::Line));
  sound = sound && is_aligned(content.corners(), alignof(fbs::Corner));
  for (std::size_t i = 0; sound && i < size_of(content.planes()); ++i) {
    sound = is_aligned(content.planes()->Get(static_cast<flatbuffers::uoffset_t>(i))->outline_room(), alignof(float));
  }
  return sound;
}

}  // namespace

Status check_header(std::span<const std::byte> bytes, FileHeader& header, std::span<const std::byte>& payload) {
  if (reinterpret_cast<uintptr_t>(bytes.data()) % alignof(FileHeader) != 0) {
    return {StatusCode::kInvalidArgument, "the map's bytes are not aligned to 8"};
  }
  if (bytes.size() < sizeof header.magic) return corrupt("truncated before the end of the magic; copy the file again");
  FileHeader read{};
  std::memcpy(&read, bytes.data(), bytes.size() < sizeof read ? bytes.size() : sizeof read);
  if (read.magic != kMagic) return {StatusCode::kUnsupported, "not a room map (other magic)"};
  if (bytes.size() < sizeof read) return corrupt("truncated within the header; copy the file again");
  // Before the sum: another version may lay its header out in another way.
  if (read.version != kFormatVersion) {
    return {StatusCode::kUnsupported, "a room map of another format version; bake it with this release's roomcal"};
  }
  if (crc32c(bytes.first(offsetof(FileHeader, header_crc32c))) != read.header_crc32c) {
    return corrupt("the header's checksum is wrong; copy the file again");
  }
  payload = bytes.subspan(sizeof read);
  if (payload.size() < read.payload_bytes) return corrupt("truncated: shorter than its header says; copy it again");
  if (payload.size() > read.payload_bytes) return corrupt("bytes follow the content; copy the file again");
  if (crc32c(payload) != read.payload_crc32c) return corrupt("the content's checksum is wrong; copy the file again");
  header = read;
  return ok_status();
}

const fbs::RoomMap* check_structure(std::span<const std::byte> payload) {
  const auto* data = reinterpret_cast<const uint8_t*>(payload.data());
  constexpr flatbuffers::uoffset_t kMaxDepth = 4;                // the schema nests two deep
  constexpr flatbuffers::uoffset_t kMaxTables = kMaxPlanes + 2;  // root, planes
  // Its smallest size (root offset and identifier), because the verifier of FlatBuffers 2.0 asserts below it.
  if (payload.size() < 8 || payload.size() >= FLATBUFFERS_MAX_BUFFER_SIZE) return nullptr;
  flatbuffers::Verifier verifier(data, payload.size(), kMaxDepth, kMaxTables);
  if (!fbs::VerifyRoomMapBuffer(verifier)) return nullptr;
  const fbs::RoomMap* content = fbs::GetRoomMap(data);
  return is_layout_sound(*content) ? content : nullptr;
}

Status check_content(const fbs::RoomMap& content) {
  const std::size_t markers = size_of(content.markers());
  const std::size_t planes = size_of(content.planes());
  if (markers == 0) return corrupt("the map holds no marker; bake it again");
  if (markers > kMaxMarkers) return corrupt("more than 4096 markers; split the room");
  if (planes > kMaxPlanes) return corrupt("more than 256 planes; bake the map again");
  for (std::size_t i = 0; i < markers; ++i) {
    const auto at = static_cast<flatbuffers::uoffset_t>(i);
    ROOMCAL_TRY(check_marker(*content.markers()->Get(at), planes));
    if (i > 0 && content.markers()->Get(at)->id() <= content.markers()->Get(at - 1)->id()) {
      return corrupt("marker ids do not ascend; bake the map again");
    }
  }
  for (std::size_t i = 0; i < planes; ++i) {
    ROOMCAL_TRY(check_plane(*content.planes()->Get(static_cast<flatbuffers::uoffset_t>(i))));
  }
  ROOMCAL_TRY(check_triangles(content.triangles(), markers));
  ROOMCAL_TRY(check_lines(content));
  ROOMCAL_TRY(check_corners(content));
  ROOMCAL_TRY(check_spacing(content.surface_spacing_m()));
  return check_ring_ratios(content.ring_ratios());
}

}  // namespace roomcal::map
