#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>

#include "drivers/image/health_log.h"
#include "drivers/image/recovery.h"
#include "drivers/image/stamp_check.h"
#include "drivers/os/thread.h"
#include "drivers/relay/library_camera.h"
#include "drivers/relay/relay_options.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/ports/log.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

/// The thread that calls a camera's library, and what it shares with the thread that wants images: one mutex, held for
/// moments only and never across a call of the library.
///
/// A slot is with exactly one of: the library; `offer_` (newest image, nobody has taken it); the reader; `returned_`
/// (the reader is done, the library does not have it yet).
class RelayWorker final : public Thread::Body, public LibraryCamera::Wake {
 public:
  struct Offer {
    LibraryImage image;
    ports::ImageFacts facts;
  };
  enum class FireState : uint8_t { kNone, kWanted, kDone, kFailed };

  RelayWorker(std::string_view name, const RelayOptions& options, std::unique_ptr<LibraryCamera> camera,
              const ports::SystemClocks& clocks, ports::Log& log);

  LibraryCamera& camera() { return *camera_; }

  // The reader's side.
  Status launch();
  /// How the first open() went; waits for it until the deadline.
  Status first_open(int64_t deadline_ns);
  /// @return false if it has not ended by the deadline: the library does not return.
  bool end(int64_t deadline_ns);
  /// The newest image; waits for it until the deadline. The slot is the reader's until release().
  bool take(int64_t deadline_ns, Offer& offer);
  void release(const Offer& offer, bool handed_over);
  ports::ImageHealth health();
  bool streams();
  /// @return false if the camera does not stream now.
  bool want_fire();
  bool fired(int64_t deadline_ns);

  void run() override;
  void wake() override;

 private:
  using Lock = std::unique_lock<std::mutex>;
  class Call;

  int64_t now_ns() const { return clocks_.now_ns(); }
  void wait_until(Lock& lock, std::condition_variable& condition, int64_t deadline_ns) const;
  void prepare();
  void step(const RecoveryOrder& order);
  void reopen();
  void restart();
  void close();
  void begun(const LibraryResult& result);
  void watch(int64_t until_ns);
  void look_after();
  void fire_if_wanted();
  void give_back_returned();
  void drain();
  void take_whole(const LibraryImage& image);
  void take_damaged(const LibraryImage& image);
  int offer(const Offer& fresh);
  void withdraw();
  void fault(ports::ImageFault fault);
  void expect_images(bool expected);

  const ports::SystemClocks& clocks_;
  ports::Log& log_;
  const std::unique_ptr<LibraryCamera> camera_;
  const int64_t hang_ns_;
  Thread thread_;

  std::mutex mutex_;  // of everything up to the next blank line
  std::condition_variable for_worker_, for_reader_;
  Recovery recovery_;
  HealthLog health_;
  bool woken_ = false, ending_ = false, ended_ = false;
  bool opened_once_ = false;
  Status first_open_;
  bool offered_ = false, reading_ = false;
  Offer offer_;
  FixedVector<int, kMaxLibraryBuffers> returned_;
  FireState fire_ = FireState::kNone;

  // The worker's own.
  StampCheck stamps_;
  SequenceCount numbers_;
  bool open_ = false;
  int64_t looked_after_ns_ = 0;
  int64_t drained_ns_ = 0;

  std::atomic<int64_t> in_call_since_ns_{0};  // 0: the library has returned
  std::atomic<bool> hang_told_{false};
};

}  // namespace roomcal::drivers
