#include "drivers/replay/replay_packet_source.h"

#include <algorithm>

#include "drivers/replay/file.h"
#include "runtime/base/arena.h"

namespace roomcal::drivers {

namespace {

constexpr int64_t kShortest_ns = 1'000'000;  // of a loop: one packet alone is not sent a million times a second

Status unavailable(const char* detail) { return {StatusCode::kUnavailable, detail}; }

}  // namespace

std::size_t ReplayPacketSource::memory_bytes(const ReplayPacketOptions& options, const ReplayCursor& cursor) {
  const auto shots = static_cast<std::size_t>(cursor.shots());
  std::size_t bytes = sizeof(lidar::IpFragments) + shots * sizeof(Shot) + 2 * alignof(std::max_align_t);
  for (int shot = 0; shot < cursor.shots(); ++shot)
    bytes += InputFile(cursor.path(shot, options.name.view(), ".pcap").data()).size();
  return bytes;
}

Status ReplayPacketSource::start() {
  stop();
  counters_ = {};
  const Status loaded = load();
  if (!loaded.ok()) {
    stop();
    return loaded;
  }
  const int64_t now_ns = clocks_.now_ns();
  place_ = {-1, 0};
  follow(cursor_.at(now_ns));
  loop_start_ns_ = now_ns;
  return ok_status();
}

Status ReplayPacketSource::load() {
  Arena arena(memory_);
  const std::span<lidar::IpFragments> fragments = arena.allocate<lidar::IpFragments>(1);
  shots_ = arena.allocate<Shot>(static_cast<std::size_t>(cursor_.shots()));
  if (fragments.empty() || shots_.empty()) return out_of_arena("a LiDAR's recordings");
  std::span<std::byte> free = memory_.subspan(arena.used());
  for (int shot = 0; shot < cursor_.shots(); ++shot) ROOMCAL_TRY(load_shot(shot, free, fragments[0]));
  return ok_status();
}

Status ReplayPacketSource::load_shot(int shot, std::span<std::byte>& free, lidar::IpFragments& fragments) {
  const InputFile file(cursor_.path(shot, name(), ".pcap").data());
  if (!file.found()) return unavailable("a shot of the replay folder has no .pcap of its name");
  if (file.size() > free.size()) return out_of_arena("a LiDAR's recordings");
  const std::span<std::byte> bytes = free.first(file.size());
  free = free.subspan(file.size());
  if (!file.read(0, bytes)) return unavailable("its recording cannot be read");
  const Result<lidar::PcapReader> reader = lidar::PcapReader::open(bytes, fragments);
  if (!reader.ok()) return unavailable(reader.status().detail());
  Shot& loaded = shots_[static_cast<std::size_t>(shot)];
  loaded.reader = reader.value();
  return measure(loaded);
}

/// One pass over the recording tells how many whole turns it holds. Recorders stamp late by some microseconds: a turn
/// that misses a hundredth counts as whole.
Status ReplayPacketSource::measure(Shot& shot) const {
  lidar::Datagram datagram;
  int64_t last_ns = 0;
  uint64_t packets = 0;
  while (next_of(shot, datagram)) {
    if (packets++ == 0) shot.first_ns = last_ns = datagram.arrival_ns;
    last_ns = std::max(last_ns, datagram.arrival_ns);
  }
  if (packets == 0) return unavailable("its recording holds no packet to its port");
  const int64_t span_ns = last_ns - shot.first_ns;
  const int64_t all_ns = span_ns + (packets > 1 ? span_ns / static_cast<int64_t>(packets - 1) : kShortest_ns);
  const int64_t turns = options_.turn_ns > 0 ? (all_ns + options_.turn_ns / 100) / options_.turn_ns : 0;
  shot.loop_ns = std::max(turns > 0 ? turns * options_.turn_ns : all_ns, kShortest_ns);
  shot.reader.rewind();
  shot.packets = 0;
  while (next_of(shot, datagram)) shot.packets += datagram.arrival_ns - shot.first_ns < shot.loop_ns ? 1 : 0;
  shot.reader.rewind();
  return ok_status();
}

bool ReplayPacketSource::next_of(Shot& shot, lidar::Datagram& datagram) const {
  while (shot.reader.next(datagram))
    if (options_.port == 0 || datagram.destination_port == options_.port) return true;
  return false;
}

void ReplayPacketSource::follow(const ReplayCursor::Place& place) {
  if (place.shot == place_.shot && place.since_ns == place_.since_ns) return;
  place_ = place;
  loop_start_ns_ = place.since_ns;
  have_next_ = false;
  shots_[static_cast<std::size_t>(place.shot)].reader.rewind();
}

/// A reader that was away for hours does not make us walk through all of them.
void ReplayPacketSource::skip_loops(int64_t now_ns) {
  const Shot& shot = shots_[static_cast<std::size_t>(place_.shot)];
  const int64_t loops = (now_ns - options_.stall_ns - loop_start_ns_) / shot.loop_ns - 1;
  if (loops <= 0) return;
  loop_start_ns_ += loops * shot.loop_ns;
  counters_.kernel_drops += static_cast<uint64_t>(loops) * shot.packets;
}

/// The next packet of the loop, or of the next one, into next_.
bool ReplayPacketSource::fetch() {
  Shot& shot = shots_[static_cast<std::size_t>(place_.shot)];
  while (!have_next_) {
    if (next_of(shot, next_)) {
      have_next_ = next_.arrival_ns - shot.first_ns < shot.loop_ns;
    } else {
      shot.reader.rewind();
      loop_start_ns_ += shot.loop_ns;
    }
  }
  return have_next_;
}

std::size_t ReplayPacketSource::drain(ports::PacketVisitor& visitor) {
  if (shots_.empty()) return 0;
  const int64_t now_ns = clocks_.now_ns();
  follow(cursor_.at(now_ns));
  skip_loops(now_ns);
  std::size_t delivered = 0;
  for (std::size_t looked = 0; looked < kMaxDrain && fetch(); ++looked) {
    const Shot& shot = shots_[static_cast<std::size_t>(place_.shot)];
    const int64_t due_ns = loop_start_ns_ + std::max<int64_t>(next_.arrival_ns - shot.first_ns, 0);
    if (due_ns > now_ns) break;
    have_next_ = false;
    if (now_ns - due_ns > options_.stall_ns) {
      ++counters_.kernel_drops;
      continue;
    }
    visitor.take({next_.payload, {due_ns, ClockId::kMonotonic}});
    ++counters_.delivered;
    ++delivered;
  }
  return delivered;
}

}  // namespace roomcal::drivers
