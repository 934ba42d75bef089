#pragma once

#include <cstdint>

#include "runtime/base/time.h"

namespace roomcal::drivers::cia402 {

/// Since the start; monotone.
struct SyncCounters {
  uint64_t sent = 0, refused = 0;  ///< by the bus
  uint64_t skipped = 0;            ///< the one before was not on the bus yet
  uint64_t confirmed = 0;
  uint64_t unanswered = 0;  ///< no position came before the next one
  uint64_t unasked = 0;     ///< positions that belong to no SYNC
};

/// When SYNC is due, when it was on the bus, and which answer belongs to which.
///
/// | state     | event                          | does                                | then      |
/// |-----------|--------------------------------|-------------------------------------|-----------|
/// | idle      | due                            | SYNC is sent                        | sent      |
/// | sent      | due                            | is skipped: never two on the way    | sent      |
/// | sent      | confirmed                      | its stamp is kept                   | confirmed |
/// | confirmed | answer within the window       | is paired with the stamp            | idle      |
/// | confirmed | answer outside, or other clock | is unasked                          | confirmed |
/// | confirmed | due                            | it stays unanswered; SYNC is sent   | sent      |
/// | any other | answer                         | is unasked                          | same      |
/// | confirmed | SYNC of somebody else          | it stays unanswered                 | idle      |
///
/// The stamp is that of the bus: when the drives took their positions, whatever delayed sender and answer.
class SyncPairs {
 public:
  /// @param period_ns  between SYNCs; an answer comes within half of it.
  explicit SyncPairs(int64_t period_ns) : period_ns_(period_ns) {}

  void restart(int64_t now_ns);
  /// Whether to send one now; moves to the next period.
  bool due(int64_t now_ns);
  void sent(bool ok);
  void confirmed(const Stamp& on_bus, int64_t now_ns);
  /// Somebody else sends SYNC too: the next answer may be his.
  void disturbed();
  /// @param[out] on_bus  of the SYNC that the answer belongs to. @return false if it belongs to none.
  bool pair(const Stamp& answered, Stamp& on_bus);

  /// For how long no SYNC got onto the bus.
  int64_t silent_ns(int64_t now_ns) const { return now_ns - confirmed_ns_; }
  uint32_t unanswered_in_a_row() const { return unanswered_; }
  const SyncCounters& counters() const { return counters_; }

 private:
  enum class State : uint8_t { kIdle, kSent, kConfirmed };

  void leave_unanswered();

  int64_t period_ns_;
  State state_ = State::kIdle;
  int64_t next_ns_ = 0, confirmed_ns_ = 0;
  Stamp on_bus_;
  uint32_t unanswered_ = 0;
  SyncCounters counters_;
};

}  // namespace roomcal::drivers::cia402
