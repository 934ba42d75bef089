#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace roomcal::map {

/// What is on disk in a `*.room` file, little-endian:
///
///     offset  size  field
///          0     8  magic "roommap\n"
///          8     4  format version
///         12     4  payload size n, bytes
///         16     8  created, seconds of Unix time; 0: not recorded
///         24     4  CRC-32C of the payload: the content's hash, printed by `roomcal map info` and kept in records
///         28     4  CRC-32C of bytes 0..27
///         32     n  payload: FlatBuffers, schema room.fbs, identifier "ROOM"
///
/// Nothing follows the payload. Every byte is under one of the two sums, so any flipped byte is found. `created` is
/// not under the payload's sum on purpose: the same survey baked twice is the same map with the same hash.
struct FileHeader {
  std::array<char, 8> magic;
  uint32_t version;
  uint32_t payload_bytes;
  int64_t created_unix_s;
  uint32_t payload_crc32c;
  uint32_t header_crc32c;
};
static_assert(sizeof(FileHeader) == 32 && alignof(FileHeader) == 8);
static_assert(std::is_trivially_copyable_v<FileHeader>);
static_assert(offsetof(FileHeader, created_unix_s) == 16 && offsetof(FileHeader, header_crc32c) == 28);
static_assert(std::endian::native == std::endian::little, "a big-endian reader has to swap; none of our boards is one");

inline constexpr std::array<char, 8> kMagic{'r', 'o', 'o', 'm', 'm', 'a', 'p', '\n'};
inline constexpr uint32_t kFormatVersion = 1;

/// Limits of a valid file; a reader may size its tables by them.
inline constexpr std::size_t kMaxMarkers = 4096;
inline constexpr std::size_t kMaxPlanes = 256;
inline constexpr std::size_t kMaxOutline = 256;         ///< vertices of one plane
inline constexpr std::size_t kMaxTriangles = 1U << 20;  ///< 6 MiB
inline constexpr std::size_t kMaxRingEdges = 16;
inline constexpr std::size_t kMaxLines = 1024;
inline constexpr std::size_t kMaxCorners = 1024;
inline constexpr double kMaxOffPlane_m = 0.01;  ///< of lines and corners from the planes that meet there
inline constexpr double kMinSpacing_m = 0.001;
inline constexpr double kMaxSpacing_m = 10;
inline constexpr double kMaxCoordinate_m = 1e4;  ///< beyond it, squares in float covariances lose their meaning
inline constexpr double kMaxRadius_m = 10;

/// Bits of Marker.flags.
enum MarkerFlag : uint16_t {
  kHasNormal = 1,
  kHasRadius = 2,
  kNormalEstimated = 4,  ///< from the plane fitted to its neighbours, not from the survey
};
inline constexpr uint16_t kNoPlane = 0xFFFF;

}  // namespace roomcal::map
