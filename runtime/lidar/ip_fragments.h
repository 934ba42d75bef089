#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/base/fixed_vector.h"
#include "runtime/lidar/bytes.h"

namespace roomcal::lidar {

/// A piece of an IPv4 packet's body, as its header says.
struct IpFragment {
  uint32_t source = 0, destination = 0;
  uint16_t identification = 0;
  bool more = false;   ///< others follow behind it
  std::size_t at = 0;  ///< of its first byte in the whole body
  Bytes body;          ///< must stay where it is until the packet is whole or given up
  uint64_t frame = 0;  ///< of the recording, counted; rises
};

/// Puts bodies together that came in pieces, in any order (RFC 791, section 3.2). Keeps views of the pieces and copies
/// only what is whole. About 90 kB of plain memory for whoever owns it; no allocation.
class IpFragments {
 public:
  static constexpr std::size_t kMaxBody = 65535;
  static constexpr std::size_t kMaxPieces = 512;    ///< waiting; the datagram that waits longest makes room
  static constexpr uint64_t kMaxWaitFrames = 4096;  ///< after which the identification may have been used again

  enum class Answer : uint8_t { kWaits, kWhole, kMalformed };

  /// @param[out] whole  for kWhole, valid until the next call.
  /// @return kMalformed if the pieces overlap or say that they reach beyond what IP can carry: they are given up then.
  /// Cost: a pass over the pieces that wait; for kWhole one for each of its pieces.
  Answer add(const IpFragment& piece, Bytes& whole);

  /// Gives up what still waits; counts it.
  void finish();
  /// Datagrams that never became whole, so far.
  uint64_t unfinished() const { return unfinished_; }

 private:
  void forget_old(uint64_t frame);
  void forget_datagram_of(const IpFragment& piece);
  Answer join(const IpFragment& latest, std::size_t total, Bytes& whole);

  FixedVector<IpFragment, kMaxPieces> pieces_;
  std::array<std::byte, kMaxBody> whole_{};
  uint64_t unfinished_ = 0;
};

}  // namespace roomcal::lidar
