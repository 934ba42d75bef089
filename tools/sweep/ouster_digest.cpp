#include "tools/sweep/ouster_digest.h"

#include "runtime/lidar/ouster.h"
#include "tools/sweep/md5.h"

namespace roomcal::tools {

using lidar::OusterPacket;
using lidar::OusterPixel;
using lidar::OusterProfile;

namespace {

class Digester {
 public:
  explicit Digester(const lidar::Calibration& calibration)
      : format_(calibration.ouster),
        rows_(calibration.beam_count),
        words_(OusterPacket::pixel_bytes(format_.profile) / 4) {}

  void add(lidar::Bytes payload) {
    const OusterPacket packet(format_, rows_, payload);
    for (std::size_t c = 0; c < format_.columns_per_packet; ++c) {
      put("TIMESTAMP", packet.timestamp_ns(c), 8);
      put("ENCODER_COUNT", packet.encoder(c), 4);
      put("MEASUREMENT_ID", packet.measurement_id(c), 2);
      put("STATUS", packet.status(c), 4);
      // The SDK reads it from the column's head, which only the legacy profile has.
      put("FRAME_ID", format_.profile == OusterProfile::kLegacy ? packet.frame_id() : 0, 2);
    }
    for (std::size_t r = 0; r < rows_; ++r)
      for (std::size_t c = 0; c < format_.columns_per_packet; ++c) add_pixel(packet, c, r);
  }

  std::map<std::string, std::string> digests() const {
    std::map<std::string, std::string> result;
    for (const auto& [field, bytes] : fields_) result[field] = md5_hex(bytes);
    return result;
  }

 private:
  void put(const std::string& field, uint64_t value, int bytes) {
    std::vector<std::byte>& out = fields_[field];
    for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i)));
  }

  void add_pixel(const OusterPacket& packet, std::size_t column, std::size_t row) {
    const OusterPixel pixel = packet.pixel(column, row);
    const bool legacy = format_.profile == OusterProfile::kLegacy;
    put("RANGE", pixel.range_mm, 4);
    put("RANGE2", pixel.range2_mm, 4);
    put("REFLECTIVITY", pixel.reflectivity, legacy ? 2 : 1);
    put("REFLECTIVITY2", pixel.reflectivity2, 1);
    put("SIGNAL", pixel.signal, 2);
    put("SIGNAL2", pixel.signal2, 2);
    put("NEAR_IR", pixel.near_ir, 2);
    put("FLAGS", pixel.flags, 1);
    put("FLAGS2", pixel.flags2, 1);
    for (std::size_t word = 0; word < words_; ++word)
      put("RAW32_WORD" + std::to_string(word + 1), packet.raw_word(column, row, word), 4);
  }

  const lidar::OusterFormat& format_;
  std::size_t rows_, words_;
  std::map<std::string, std::vector<std::byte>> fields_;
};

}  // namespace

std::map<std::string, std::string> ouster_digests(const std::string& name, lidar::Bytes pcap,
                                                  const lidar::Calibration& calibration) {
  PcapReader reader(name, pcap);
  Digester digester(calibration);
  Datagram datagram;
  const std::size_t size = OusterPacket::packet_bytes(calibration.ouster, calibration.beam_count);
  while (reader.next(datagram))
    if (datagram.payload.size() == size) digester.add(datagram.payload);
  return digester.digests();
}

}  // namespace roomcal::tools
