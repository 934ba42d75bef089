#include "tools/map/map_builder.h"

#include <algorithm>
#include <cstring>

#include "runtime/base/crc32c.h"
#include "runtime/map/format.h"
#include "runtime/map/room_generated.h"
#include "tools/common/error.h"

namespace roomcal::tools {

namespace fbs = map::fbs;

namespace {

fbs::Vec3f to_vec3f(const Vec3& v) {
  const Eigen::Vector3f f = v.cast<float>();
  return {f.x(), f.y(), f.z()};
}

fbs::Cov3f to_cov3f(const Mat33& m) {
  const Eigen::Matrix3f f = m.cast<float>();
  return {f(0, 0), f(0, 1), f(0, 2), f(1, 1), f(1, 2), f(2, 2)};
}

fbs::Marker to_stored(const map::MapMarker& marker) {
  unsigned flags = 0;
  if (marker.has_normal) flags |= map::kHasNormal;
  if (marker.has_radius) flags |= map::kHasRadius;
  if (marker.has_normal && marker.normal_estimated) flags |= map::kNormalEstimated;
  const Vec3& p = marker.p_room;
  return {fbs::Vec3d(p.x(), p.y(), p.z()),
          to_vec3f(marker.has_normal ? marker.normal_room : Vec3::Zero()),
          to_cov3f(marker.cov_m2),
          marker.has_radius ? static_cast<float>(marker.radius_m) : 0.0F,
          marker.id,
          marker.plane < 0 ? map::kNoPlane : static_cast<uint16_t>(marker.plane),
          static_cast<uint16_t>(flags)};
}

flatbuffers::Offset<fbs::Plane> store_plane(flatbuffers::FlatBufferBuilder& builder, const PlaneData& data) {
  std::vector<fbs::Vec3f> outline;
  for (const Vec3& vertex : data.outline_room) outline.push_back(to_vec3f(vertex));
  const fbs::Vec3d normal(data.plane.normal_room.x(), data.plane.normal_room.y(), data.plane.normal_room.z());
  const fbs::Cov3f cov = to_cov3f(data.plane.cov);
  return fbs::CreatePlaneDirect(builder, &normal, data.plane.d_m, outline.empty() ? nullptr : &outline,
                                static_cast<float>(data.plane.rms_m), data.plane.cov.isZero(0) ? nullptr : &cov);
}

std::vector<fbs::Line> store_lines(const MapData& data) {
  std::vector<fbs::Line> lines;
  for (const map::MapLine& line : data.lines) {
    lines.emplace_back(to_vec3f(line.from_room), to_vec3f(line.to_room), static_cast<uint16_t>(line.plane_a),
                       static_cast<uint16_t>(line.plane_b));
  }
  return lines;
}

std::vector<fbs::Corner> store_corners(const MapData& data) {
  std::vector<fbs::Corner> corners;
  for (const map::MapCorner& corner : data.corners) {
    const auto& [a, b, c] = corner.planes;
    corners.emplace_back(to_vec3f(corner.p_room), static_cast<uint16_t>(a), static_cast<uint16_t>(b),
                         static_cast<uint16_t>(c), uint16_t{0});
  }
  return corners;
}

void store_content(flatbuffers::FlatBufferBuilder& builder, const MapData& data) {
  std::vector<fbs::Marker> markers;
  for (const map::MapMarker& marker : data.markers) markers.push_back(to_stored(marker));
  std::vector<flatbuffers::Offset<fbs::Plane>> planes;
  for (const PlaneData& plane : data.planes) planes.push_back(store_plane(builder, plane));
  std::vector<fbs::Triangle> triangles;
  for (const auto& [a, b, c] : data.triangles) triangles.emplace_back(a, b, c);
  const std::vector<fbs::Line> lines = store_lines(data);
  const std::vector<fbs::Corner> corners = store_corners(data);
  const auto content =
      fbs::CreateRoomMapDirect(builder, data.id.c_str(), data.provenance.c_str(), &markers, &planes, &triangles,
                               data.ring_ratios.empty() ? nullptr : &data.ring_ratios, lines.empty() ? nullptr : &lines,
                               corners.empty() ? nullptr : &corners, static_cast<float>(data.surface_spacing_m));
  fbs::FinishRoomMapBuffer(builder, content);
}

AlignedBytes with_header(std::span<const uint8_t> payload, int64_t created_unix_s) {
  map::FileHeader header{map::kMagic,
                         map::kFormatVersion,
                         static_cast<uint32_t>(payload.size()),
                         created_unix_s,
                         crc32c(std::as_bytes(payload)),
                         0};
  const std::span<const std::byte> header_bytes = std::as_bytes(std::span(&header, 1));
  header.header_crc32c = crc32c(header_bytes.first(offsetof(map::FileHeader, header_crc32c)));
  AlignedBytes bytes(sizeof header + payload.size());
  std::memcpy(bytes.span().data(), &header, sizeof header);
  std::memcpy(bytes.span().data() + sizeof header, payload.data(), payload.size());
  return bytes;
}

}  // namespace

AlignedBytes build_map(const MapData& data) {
  if (data.markers.size() > map::kMaxMarkers) {
    throw ToolError("map: " + std::to_string(data.markers.size()) + " markers; a map holds " +
                    std::to_string(map::kMaxMarkers) + " at most, split the room");
  }
  for (const map::MapMarker& marker : data.markers) {
    if (marker.plane >= static_cast<int>(data.planes.size())) {
      throw ToolError("map: marker " + std::to_string(marker.id) + " names a plane that is not in the map");
    }
  }
  flatbuffers::FlatBufferBuilder builder(128 * 1024);
  store_content(builder, data);
  AlignedBytes bytes = with_header({builder.GetBufferPointer(), builder.GetSize()}, data.created_unix_s);
  require(map::RoomMap::open(bytes.span()).status(), "map");
  return bytes;
}

MapData to_map_data(const map::RoomMap& map) {
  MapData data;
  data.id = map.map_id();
  data.provenance = map.provenance();
  data.created_unix_s = map.created_unix_s();
  for (std::size_t i = 0; i < map.marker_count(); ++i) data.markers.push_back(map.marker(i));
  for (std::size_t i = 0; i < map.plane_count(); ++i) {
    PlaneData plane{map.plane(i), {}};
    for (std::size_t k = 0; k < map.outline_size(i); ++k) plane.outline_room.push_back(map.outline_vertex_room(i, k));
    data.planes.push_back(std::move(plane));
  }
  data.triangles.assign(map.triangles().begin(), map.triangles().end());
  data.ring_ratios.assign(map.ring_ratios().begin(), map.ring_ratios().end());
  for (std::size_t i = 0; i < map.line_count(); ++i) data.lines.push_back(map.line(i));
  for (std::size_t i = 0; i < map.corner_count(); ++i) data.corners.push_back(map.corner(i));
  data.surface_spacing_m = map.surface_spacing_m();
  return data;
}

LoadedMap load_map(const std::filesystem::path& path) {
  AlignedBytes bytes = read_bytes(path);
  const Result<map::RoomMap> opened = map::RoomMap::open(std::as_const(bytes).span());
  require(opened.status(), path.string());
  return {std::move(bytes), opened.value()};
}

}  // namespace roomcal::tools
