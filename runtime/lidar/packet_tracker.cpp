#include "runtime/lidar/packet_tracker.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace roomcal::lidar {

namespace {

// A clock that jumps farther was set, or belongs to another recording. Networks do reorder packets, but by far less
// than half a turn at 20 Hz: what is older than that was not overtaken, it is a recording that starts over.
constexpr int64_t kAhead_ns = 1'000'000'000, kBack_ns = 25'000'000;
constexpr uint32_t kMaxLost = 100'000;  // more at once is a counter that was reset

/// 64-bit fingerprint of a packet's bytes: FNV-1a by words, finished as SplitMix64 does. Never 0.
uint64_t fingerprint(Bytes bytes) {
  uint64_t hash = 0xCBF29CE484222325U ^ bytes.size();
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, 8);
    hash = (hash ^ word) * 0x100000001B3U;
    hash ^= hash >> 29;
  }
  for (; i < bytes.size(); ++i) hash = (hash ^ u8(bytes, i)) * 0x100000001B3U;
  hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9U;
  return (hash ^ (hash >> 27)) | 1;
}

}  // namespace

bool PacketTracker::seen(Bytes bytes) {
  const uint64_t mark = fingerprint(bytes);
  if (std::find(recent_.begin(), recent_.end(), mark) != recent_.end()) return true;
  recent_[recent_next_] = mark;
  recent_next_ = (recent_next_ + 1) % recent_.size();
  return false;
}

int64_t PacketTracker::since_last(const PacketHeader& header) const {
  int64_t after = header.stamp_ns - last_raw_ns_;
  if (header.stamp_modulo_ns == 0) return after;
  if (after < -header.stamp_modulo_ns / 2) after += header.stamp_modulo_ns;
  if (after > header.stamp_modulo_ns / 2) after -= header.stamp_modulo_ns;
  return after;
}

uint32_t PacketTracker::lost_before(const PacketHeader& header, int64_t after_ns) const {
  if (header.has_sequence) {
    const uint32_t step = (header.sequence - last_sequence_) & header.sequence_mask;
    return step > 1 && step - 1 <= kMaxLost && step <= header.sequence_mask / 2 ? step - 1 : 0;
  }
  if (header.interval_ns == 0) return 0;
  const int64_t steps = (after_ns + header.interval_ns / 2) / header.interval_ns;
  return steps > 1 ? static_cast<uint32_t>(steps - 1) : 0;
}

PacketPlace PacketTracker::place(const PacketHeader& header, Bytes bytes) {
  PacketPlace place;
  if (seen(bytes)) {
    place.order = PacketOrder::kDuplicate;
    return place;
  }
  const int64_t after_ns = any_ ? since_last(header) : 0;
  if (!any_) {
    place.order = PacketOrder::kFirst;
  } else if (after_ns > kAhead_ns || after_ns < -kBack_ns) {
    place.order = PacketOrder::kRestart;
  } else {
    place.order = after_ns < 0 ? PacketOrder::kLate : PacketOrder::kNext;
  }
  const bool continues = place.order == PacketOrder::kNext || place.order == PacketOrder::kLate;
  place.stamp_ns = continues ? last_ns_ + after_ns : header.stamp_ns;
  place.after_ns = after_ns;
  if (place.order == PacketOrder::kLate) return place;  // the latest one stays the reference
  if (place.order == PacketOrder::kNext) {
    place.lost = lost_before(header, after_ns);
    place.in_pace = header.interval_ns == 0 || std::abs(after_ns - header.interval_ns) * 10 < header.interval_ns;
  }
  any_ = true;
  last_raw_ns_ = header.stamp_ns;
  last_ns_ = place.stamp_ns;
  last_sequence_ = header.sequence;
  return place;
}

}  // namespace roomcal::lidar
