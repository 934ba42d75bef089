#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/lidar/packet.h"
#include "runtime/lidar/packet_tracker.h"
#include "runtime/lidar/sweep.h"

namespace roomcal::lidar {

/// Where turns are cut at the azimuth of the first packet: a recording of n turns then gives n whole sweeps.
inline constexpr int kCutAtFirstAzimuth = -1;

struct SweepOptions {
  std::size_t capacity = 120'000;     ///< points of one sweep; a VLP-16 at 10 Hz gives 28,800, 57,600 in dual return
  int cut_cdeg = kCutAtFirstAzimuth;  ///< hundredths of a degree, sensor's azimuth; kCutAtFirstAzimuth: see there
  int64_t period_ns = 100'000'000;    ///< of a sweep of a sensor without turns (Livox)
};

/// Everything that happened since create().
struct SweepCounters {
  uint32_t packets = 0;  ///< that gave points or could have
  uint32_t lost = 0, late_used = 0, late_dropped = 0, duplicates = 0, restarts = 0;
  uint32_t unsupported = 0, corrupt = 0, empty = 0;  ///< refused: not this model's; damaged; without valid columns
  uint32_t other_sensor = 0, checksum_wrong = 0, out_of_pace = 0, azimuth_jumps = 0;
  uint64_t points = 0, absurd_ranges = 0, dropped_points = 0;
  uint32_t sweeps = 0;
};

/// Cuts a stream of packets, live or replayed, into sweeps.
///
/// State table. "Passes the cut" is by azimuth (Velodyne, Hesai, RoboSense), by turn number (Ouster, R2000), or by time
/// (Livox). A closed sweep is partial if it began or ended away from the cut.
///
/// | state | packet                                | does                                               | then |
/// |-------|---------------------------------------|----------------------------------------------------|------|
/// | idle  | any good one                          | opens a sweep                                      | open |
/// | open  | next, before the cut                  | appends                                            | open |
/// | open  | next, passes the cut                  | closes at the cut, opens with the rest             | open |
/// | open  | next, after lost ones                 | counts them, flags kSweepLostPackets               | open |
/// | open  | next, after a pause of 25 ms or more  | closes (partial, lost), opens (partial)            | open |
/// | open  | late, of this sweep                   | appends, flags kSweepOutOfOrder                    | open |
/// | open  | late, of a sweep that is closed       | drops, flags kSweepOutOfOrder                      | open |
/// | any   | the same bytes again                  | drops, flags kSweepDuplicates                      | same |
/// | open  | azimuths jump, times do not           | appends, flags kSweepBadPackets                    | open |
/// | any   | damaged or of something else          | refuses with a reason, flags kSweepBadPackets      | same |
/// | open  | clock 1 s ahead, or 25 ms back        | closes, opens; partial where away from the cut     | open |
/// | open  | 2 s without a cut                     | closes (partial), opens (partial)                  | open |
/// | open  | finish()                              | closes                                             | idle |
class SweepBuilder {
 public:
  SweepBuilder() = default;

  /// Bytes that create() takes from its arena.
  static std::size_t arena_bytes(const SweepOptions& options);

  /// @param calibration  must outlive the builder.
  /// @return kInvalidArgument for a cut that is no azimuth or no capacity; kOutOfMemory.
  static Result<SweepBuilder> create(const Calibration& calibration, const SweepOptions& options, Arena& arena);

  /// One UDP payload of the sensor's data port. Afterwards ready() tells whether a sweep was completed by it.
  /// @return why the packet was refused (counted too), see inspect_packet(). Cost: about 7 ns a point, no allocation.
  Status push(Bytes packet);

  /// No more packets: closes the open sweep.
  void finish();

  /// A sweep is complete, to be had from sweep() until the next push() or finish().
  bool ready() const { return ready_; }
  const Sweep& sweep() const { return done_; }

  const SweepCounters& counters() const { return counters_; }
  /// Of the last good packet.
  const PacketHeader& last_header() const { return header_; }

 private:
  struct Open {
    bool any = false;
    int64_t stamp_ns = 0, last_ns = 0;
    uint32_t flags = 0, packets = 0, lost = 0, pace_checked = 0, in_pace = 0;
    uint32_t turn = 0, units = 0, turn_units = 0;
    int progress_cdeg = 0;  ///< since the cut
  };

  void release();
  Status add(Bytes packet, const PacketPlace& place);
  Status add_late(Bytes packet, const PacketPlace& place);
  void count_place(const PacketPlace& place);
  bool passes_cut_before(const PacketPlace& place) const;
  bool interrupted_before(const PacketPlace& place) const;
  void check_jump(const DecodedPacket& decoded, const PacketPlace& place);
  void append_by_azimuth(const DecodedPacket& decoded, int64_t stamp_ns);
  void append(std::size_t begin, std::size_t end);
  void open(int64_t stamp_ns, int azimuth_cdeg);
  void close(bool at_cut);
  uint32_t flags_at_close(bool at_cut) const;
  bool whole(bool at_cut) const;
  void note_header();
  std::size_t open_points() const { return used_ - done_points_; }

  const Calibration* calibration_ = nullptr;
  SweepOptions options_;
  std::span<SweepPoint> points_;  ///< [0, done_points_) the finished sweep, [done_points_, used_) the open one
  std::size_t done_points_ = 0, used_ = 0;
  bool ready_ = false;
  Sweep done_;
  Open open_;
  int cut_cdeg_ = kCutAtFirstAzimuth;
  int last_azimuth_cdeg_ = 0, step_cdeg_ = 0;
  bool jumped_within_ = false;  ///< the last packet's azimuths have a jump: right only if a pause follows
  bool first_sweep_ = true;
  uint32_t pending_flags_ = 0;  ///< of what was dropped while no sweep was open
  PacketTracker tracker_;
  PacketHeader header_;
  SweepCounters counters_;
};

}  // namespace roomcal::lidar
