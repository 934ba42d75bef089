#pragma once

#include <cstdint>
#include <limits>

#include "runtime/ports/image_source.h"

namespace roomcal::drivers {

/// Whether a fault means that the camera cannot be had at all now: it is looked for until it can.
bool is_absence(ports::ImageFault fault);

/// What a camera's driver is to do now.
enum class RecoveryStep : uint8_t {
  kWatch,          ///< wait for an image until `until_ns`; if none came by then, that is a stall
  kRestartStream,  ///< stop the stream and start it
  kReopen,         ///< close the device if it is open, look for the camera by its key, open it, start the stream
  kResetPort,      ///< close, then cut the power of the port or whatever the board has for that
  kStayClosed,     ///< close the device if it is open; nothing else before `until_ns`
  kGiveUp,         ///< close the device if it is open; only start() tries again
};
/// "watch", "restart stream", ... Never null.
const char* to_string(RecoveryStep step);

struct RecoveryOrder {
  RecoveryStep step = RecoveryStep::kGiveUp;
  int64_t until_ns = 0;  ///< monotonic; of kWatch and kStayClosed
};

/// The defaults suit a free-running camera from 10 images a second.
struct RecoveryOptions {
  int64_t stall_ns = 500'000'000;            ///< waiting for an image for that long is a stall; several periods
  int64_t first_image_ns = 3'000'000'000;    ///< the same for the first image after a start: sensors settle
  int64_t healthy_ns = 30'000'000'000;       ///< images for that long without trouble fill the budget up again
  int64_t shortest_wait_ns = 1'000'000'000;  ///< before a camera that is not there is looked for again; doubles
  int64_t longest_wait_ns = 30'000'000'000;  ///< up to here; a driver for which looking is cheap takes less
  int damaged_in_a_row = 3;                  ///< so many images, none whole in between, restart the stream
  int restarts = 2;                          ///< budget
  int reopens = 2;                           ///< budget
  bool may_reset_port = false;               ///< once, where the board can and nothing else hangs on that port
};

/// How a camera is brought back: pure, no clock and no system call of its own. Time is monotonic nanoseconds. The watch
/// for an image runs only while somebody waits for one, resume() to pause().
///
/// | fault | kind | what follows |
/// |---|---|---|
/// | stamp faults | note | nothing: they are counted |
/// | marked damaged, short, undecodable, transient | image | at the third in a row as `stream` |
/// | stall, end of stream, unknown buffer | stream | restart; no budget left: as `device` |
/// | stale, no buffers, no bandwidth | device | reopen, again after 1 s; no budget left: reset the port; give up |
/// | gone, not found, busy, not permitted | absent | close, reopen after 1 s, 2 s, 4 s ... 30 s, for ever, budget
/// untouched | | wrong format | hopeless | give up |
///
/// | state | event | next |
/// |---|---|---|
/// | any | start() | opening |
/// | opening | begun() | watching, with the patience for a first image |
/// | opening | port_reset() | opening: reopen after 1 s |
/// | opening | fault | as above, but `image` and `stream` (it cannot be started) as `device` |
/// | watching | image() | watching |
/// | watching | fault | as above |
/// | given up | anything but start() | given up |
///
/// An image after trouble ends it. The budget is full again after `healthy_ns` of images without trouble, or when a
/// camera that was unplugged streams again.
class Recovery {
 public:
  explicit Recovery(const RecoveryOptions& options = {}) : options_(options) {}

  /// The camera is about to be opened; forgets everything. Nobody waits yet.
  void start(int64_t now_ns);
  /// Stopped on purpose: kClosed until start().
  void stop() { *this = Recovery(options_); }
  /// The stream runs: after start, or as ordered.
  void begun(int64_t now_ns);
  /// The port was reset, as ordered.
  void port_reset(int64_t now_ns);
  /// A whole image came.
  void image(int64_t now_ns);
  /// Something went wrong: with an image, with the stream, or with a step that was ordered.
  void fault(ports::ImageFault fault, int64_t now_ns);

  /// Somebody waits for images from now on, or no longer: a camera that nobody asks does not stall.
  void resume(int64_t now_ns);
  void pause(int64_t now_ns);

  /// @return what to do now. Says the same until begun(), port_reset(), image() or fault() tells how it went.
  RecoveryOrder order(int64_t now_ns) const;
  /// @return true if the wait for an image was too long: report fault(kStall).
  bool stalled(int64_t now_ns) const;
  /// kStreaming while images come or may be expected to, kClosed before start().
  ports::SourceState state() const;

 private:
  enum class State : uint8_t { kClosed, kOpening, kWatching, kGivenUp };

  void image_damaged(int64_t now_ns);
  void stream_failed(int64_t now_ns);
  void device_failed(int64_t now_ns);
  void camera_absent(int64_t now_ns);
  void plan(RecoveryStep step, int64_t at_ns);
  void fill_budget();

  RecoveryOptions options_;
  State state_ = State::kClosed;
  RecoveryStep step_ = RecoveryStep::kReopen;  // of kOpening
  int64_t step_at_ns_ = 0;
  int64_t watch_until_ns_ = 0;
  int64_t paused_at_ns_ = 0;
  int64_t well_since_ns_ = 0;
  int64_t next_wait_ns_ = 0;
  int damaged_ = 0;
  int restarts_left_ = 0;
  int reopens_left_ = 0;
  bool reset_left_ = false;
  bool paused_ = false;
  bool trouble_ = false;  // since the last image
  bool absent_ = false;   // was unplugged, and has not streamed since
};

}  // namespace roomcal::drivers
