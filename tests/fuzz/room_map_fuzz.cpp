#include <vector>

#include "runtime/map/format.h"
#include "runtime/map/sample_surface.h"
#include "tests/fuzz/sealed.h"
#include "tools/map/map_builder.h"

namespace {

using namespace roomcal;

void walk(std::span<const std::byte> bytes) {
  const Result<map::RoomMap> opened = map::RoomMap::open(bytes);
  if (!opened.ok()) return;
  const tools::MapData data = tools::to_map_data(opened.value());
  for (const auto& [a, b, c] : data.triangles) {
    if (a >= data.markers.size() || b >= data.markers.size() || c >= data.markers.size()) __builtin_trap();
  }
  for (const map::MapLine& line : data.lines) {
    if (line.plane_a >= data.planes.size() || line.plane_b >= data.planes.size()) __builtin_trap();
    if (!line.from_room.allFinite() || !line.to_room.allFinite()) __builtin_trap();
  }
  for (const map::MapCorner& corner : data.corners) {
    for (const std::size_t plane : corner.planes) {
      if (plane >= data.planes.size()) __builtin_trap();
    }
    if (!corner.p_room.allFinite()) __builtin_trap();
  }
  std::vector<std::byte> memory(64 * 1024);
  Arena arena(memory);
  std::span<map::SurfacePoint> points;
  if (map::sample_surface(opened.value(), 0, arena, points).ok() && points.size() > 4096) __builtin_trap();
  for (const map::MapMarker& marker : data.markers) {
    if (!marker.p_room.allFinite() || !marker.cov_m2.allFinite()) __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  fuzz::walk_sealed<map::FileHeader>(data, size, map::kMagic, map::kFormatVersion, walk);
  return 0;
}
