#include <cstring>
#include <memory>
#include <vector>

#include "runtime/base/crc32c.h"
#include "runtime/map/format.h"
#include "runtime/map/sample_surface.h"
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

// With sums made to fit, so that the fuzzer gets past them to what they guard.
void reseal(std::span<std::byte> bytes) {
  map::FileHeader header{};
  if (bytes.size() < sizeof header) return;
  std::memcpy(&header, bytes.data(), sizeof header);
  header.magic = map::kMagic;
  header.version = map::kFormatVersion;
  header.payload_bytes = static_cast<uint32_t>(bytes.size() - sizeof header);
  header.payload_crc32c = crc32c(bytes.subspan(sizeof header));
  std::memcpy(bytes.data(), &header, sizeof header);
  header.header_crc32c = crc32c(bytes.first(offsetof(map::FileHeader, header_crc32c)));
  std::memcpy(bytes.data(), &header, sizeof header);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  // A heap block of exactly this size, so that reading one byte too far is seen.
  const std::unique_ptr<std::byte[]> block(new std::byte[size]);
  if (size > 0) std::memcpy(block.get(), data, size);
  const std::span<std::byte> bytes(block.get(), size);
  walk(bytes);
  reseal(bytes);
  walk(bytes);
  return 0;
}
