#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace roomcal::drivers {

/// Puts this process into a network of its own that has the loopback addresses 127.0.0.1 and 127.0.0.2 and nothing
/// else, once; before the first thread is started. Tests then run side by side, and meet no real camera.
/// @return empty, or why that cannot be done.
std::string enter_own_network();
/// Empty, or why Debian's fake GigE Vision camera cannot be run.
std::string why_no_fake_cameras();

/// Debian's fake GigE Vision camera as a process (arv-fake-gv-camera-0.8): 25 images of 512 x 512 a second, stamped
/// with the host's real time, taken at multiples of 40 ms of it, so that two of them are synchronous.
class FakeGigeCamera {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    std::string serial = "FAKE1";
    double lost_per_thousand = 0;   ///< packets
    std::string genicam_file = {};  ///< another description of its registers; empty: its own
  };

  explicit FakeGigeCamera(Options options) : options_(std::move(options)) { start(); }
  ~FakeGigeCamera() { kill(); }
  FakeGigeCamera(const FakeGigeCamera&) = delete;
  FakeGigeCamera& operator=(const FakeGigeCamera&) = delete;

  void start();        ///< returns when it answers
  void kill();         ///< SIGKILL: as if its plug were pulled
  void hang(bool on);  ///< it is there, and does nothing
  const std::string& serial() const { return options_.serial; }

 private:
  void wait_until_it_answers() const;

  Options options_;
  pid_t pid_ = -1;
};

}  // namespace roomcal::drivers
