#pragma once

#include <cstdint>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/base/time.h"
#include "runtime/lidar/bytes.h"
#include "runtime/lidar/calibration.h"
#include "runtime/lidar/sweep.h"

namespace roomcal::lidar {

/// What a UDP payload on a LiDAR's network is.
enum class PacketKind : uint8_t {
  kPoints,
  kPosition,  ///< GPS/IMU position packet of a Velodyne, GPS packet of a Hesai
  kDifop,     ///< RoboSense device information
  kImu,
  kOther,
};
const char* to_string(PacketKind kind);

/// How the packets of a family say that a turn is over.
enum class TurnMark : uint8_t {
  kAzimuth,  ///< the azimuth passes the cut
  kNumber,   ///< packets carry the number of their turn
  kTime,     ///< no turns at all (Livox): a period of time
};

/// What a point packet says of itself, before any point is decoded.
struct PacketHeader {
  int64_t stamp_ns = 0;         ///< of the first firing, sensor's clock
  int64_t stamp_modulo_ns = 0;  ///< the clock starts again after this long (Velodyne: the hour); 0: never
  TurnMark turn_mark = TurnMark::kAzimuth;
  bool has_sequence = false;
  uint32_t sequence = 0;
  uint32_t sequence_mask = 0xFFFFFFFF;  ///< the number starts again after this one
  uint32_t turn = 0;                    ///< kNumber: which turn
  uint32_t turn_mask = 0xFFFF;          ///< kNumber: the number starts again after this one
  uint32_t turn_units = 0;              ///< kNumber: columns or points of a whole turn
  uint32_t packet_units = 0;            ///< kNumber: of them in this packet
  uint32_t first_unit = 0;              ///< kNumber: position of the packet in the turn
  int64_t interval_ns = 0;              ///< between packets of this model and mode by the manual; 0: varies
  uint8_t returns = 1;                  ///< points that one firing may give
  uint8_t return_mode = 0;              ///< as the packet says it
  uint8_t product_byte = 0;             ///< as the packet says it
  bool other_sensor = false;            ///< names another model or unit than the calibration's
  bool checksum_wrong = false;
  uint16_t motor_rpm = 0;  ///< 0: not said
};

/// A firing sequence (Velodyne, Hesai, RoboSense block) within a decoded packet.
struct BlockMark {
  uint16_t azimuth_cdeg = 0;  ///< hundredths of a degree, [0, 36000)
  uint16_t end = 0;           ///< one past its last point
  int32_t offset_ns = 0;      ///< after the packet's stamp
};

/// What decode_packet() found besides the points.
struct DecodedPacket {
  std::size_t point_count = 0;
  uint32_t absurd_ranges = 0;         ///< dropped: beyond what the model can measure
  FixedVector<BlockMark, 16> blocks;  ///< kAzimuth only; a dual-return pair is one block
};

/// The most points that one packet can give.
inline constexpr std::size_t kMaxPacketPoints = 4096;

/// Tells a point packet of this model from others that share its network, by size and magic; looks at no more.
PacketKind classify_packet(Model model, Bytes bytes);

/// The model that a packet is of by its own marks. @return nullptr if nobody's. Ouster packets carry no mark: never
/// named.
const ModelInfo* identify_packet(Bytes bytes);

/// Reads and checks a point packet's header and trailer.
/// @return kUnsupported if it is not a point packet of this calibration's model and format, kCorrupt if its fields
///         contradict each other. `header` is then unspecified. Cost: about 30 ns, no allocation.
Status inspect_packet(const Calibration& calibration, Bytes bytes, PacketHeader& header);

/// Points of a packet that inspect_packet() accepted with `header`.
///
/// @param base_ns  added to every offset_ns: the packet's stamp after the sweep's.
/// @param[out] points  room for kMaxPacketPoints; the first point_count are written.
/// @return kCapacity if `points` is too small. Cost: about 7 ns a point, no allocation.
Status decode_packet(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                     std::span<SweepPoint> points, DecodedPacket& decoded);

}  // namespace roomcal::lidar
