#include "runtime/map/room_map.h"

#include <cassert>

#include "runtime/map/check.h"
#include "runtime/map/format.h"
#include "runtime/map/room_generated.h"

namespace roomcal::map {

namespace {

// triangles() hands out the file's structs as arrays; both are three uint16_t in a row.
static_assert(sizeof(std::array<uint16_t, 3>) == sizeof(fbs::Triangle));
static_assert(alignof(std::array<uint16_t, 3>) == alignof(fbs::Triangle));
static_assert(sizeof(fbs::Marker) == 72 && sizeof(fbs::Line) == 28 && sizeof(fbs::Corner) == 20,
              "frozen: a change moves kFormatVersion");

Vec3 to_vec3(const fbs::Vec3d& v) { return {v.x(), v.y(), v.z()}; }
Vec3 to_vec3(const fbs::Vec3f& v) { return {v.x(), v.y(), v.z()}; }

Mat33 to_mat33(const fbs::Cov3f& c) {
  Mat33 m;
  m << c.xx(), c.xy(), c.xz(), c.xy(), c.yy(), c.yz(), c.xz(), c.yz(), c.zz();
  return m;
}

const fbs::Plane& plane_at(const fbs::RoomMap& content, std::size_t i) {
  assert(i < content.planes()->size());
  return *content.planes()->Get(static_cast<flatbuffers::uoffset_t>(i));
}

std::string_view to_view(const flatbuffers::String& text) { return {text.c_str(), text.size()}; }

}  // namespace

Result<RoomMap> RoomMap::open(std::span<const std::byte> bytes) {
  FileHeader header{};
  std::span<const std::byte> payload;
  ROOMCAL_TRY(check_header(bytes, header, payload));
  const fbs::RoomMap* content = check_structure(payload);
  if (content == nullptr) return Status(StatusCode::kCorrupt, "the content's structure is broken; bake the map again");
  ROOMCAL_TRY(check_content(*content));
  RoomMap map;
  map.content_ = content;
  map.marker_count_ = content->markers()->size();
  map.created_unix_s_ = header.created_unix_s;
  map.content_crc32c_ = header.payload_crc32c;
  return map;
}

MapMarker RoomMap::marker(std::size_t i) const {
  assert(i < marker_count_);
  const fbs::Marker& stored = *content_->markers()->Get(static_cast<flatbuffers::uoffset_t>(i));
  MapMarker marker;
  marker.id = stored.id();
  marker.p_room = to_vec3(stored.p_room());
  marker.cov_m2 = to_mat33(stored.cov_m2());
  marker.has_normal = (stored.flags() & kHasNormal) != 0;
  if (marker.has_normal) marker.normal_room = to_vec3(stored.normal_room());
  marker.normal_estimated = (stored.flags() & kNormalEstimated) != 0;
  marker.has_radius = (stored.flags() & kHasRadius) != 0;
  marker.radius_m = stored.radius_m();
  marker.plane = stored.plane() == kNoPlane ? -1 : stored.plane();
  return marker;
}

std::size_t RoomMap::plane_count() const {
  return content_ == nullptr || content_->planes() == nullptr ? 0 : content_->planes()->size();
}

MapPlane RoomMap::plane(std::size_t i) const {
  const fbs::Plane& stored = plane_at(*content_, i);
  MapPlane plane{to_vec3(*stored.normal_room()), stored.d_m(), static_cast<double>(stored.rms_m())};
  if (stored.cov() != nullptr) plane.cov = to_mat33(*stored.cov());
  return plane;
}

std::size_t RoomMap::outline_size(std::size_t plane) const {
  const auto* outline = plane_at(*content_, plane).outline_room();
  return outline == nullptr ? 0 : outline->size();
}

Vec3 RoomMap::outline_vertex_room(std::size_t plane, std::size_t vertex) const {
  assert(vertex < outline_size(plane));
  return to_vec3(*plane_at(*content_, plane).outline_room()->Get(static_cast<flatbuffers::uoffset_t>(vertex)));
}

std::size_t RoomMap::line_count() const {
  return content_ == nullptr || content_->lines() == nullptr ? 0 : content_->lines()->size();
}

MapLine RoomMap::line(std::size_t i) const {
  assert(i < line_count());
  const fbs::Line& stored = *content_->lines()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return {stored.plane_a(), stored.plane_b(), to_vec3(stored.from_room()), to_vec3(stored.to_room())};
}

std::size_t RoomMap::corner_count() const {
  return content_ == nullptr || content_->corners() == nullptr ? 0 : content_->corners()->size();
}

MapCorner RoomMap::corner(std::size_t i) const {
  assert(i < corner_count());
  const fbs::Corner& stored = *content_->corners()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return {{stored.plane_a(), stored.plane_b(), stored.plane_c()}, to_vec3(stored.p_room())};
}

double RoomMap::surface_spacing_m() const {
  return content_ == nullptr ? 0 : static_cast<double>(content_->surface_spacing_m());
}

std::span<const std::array<uint16_t, 3>> RoomMap::triangles() const {
  if (content_ == nullptr || content_->triangles() == nullptr) return {};
  const auto* first = reinterpret_cast<const std::array<uint16_t, 3>*>(content_->triangles()->Data());
  return {first, content_->triangles()->size()};
}

std::span<const float> RoomMap::ring_ratios() const {
  if (content_ == nullptr || content_->ring_ratios() == nullptr) return {};
  return {content_->ring_ratios()->data(), content_->ring_ratios()->size()};
}

std::string_view RoomMap::map_id() const {
  return content_ == nullptr ? std::string_view{} : to_view(*content_->map_id());
}

std::string_view RoomMap::provenance() const {
  return content_ == nullptr ? std::string_view{} : to_view(*content_->provenance());
}

}  // namespace roomcal::map
