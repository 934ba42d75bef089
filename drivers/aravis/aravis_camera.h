#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

#include <arv.h>
#include <netinet/in.h>

#include "drivers/aravis/aravis_options.h"
#include "drivers/aravis/burial.h"
#include "drivers/aravis/discovery.h"
#include "drivers/aravis/features.h"
#include "drivers/aravis/pixel_formats.h"
#include "drivers/aravis/stamping.h"
#include "drivers/image/health_log.h"
#include "drivers/relay/library_camera.h"
#include "runtime/ports/log.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

/// A GigE Vision or USB3 Vision camera by Aravis 0.8.
class AravisCamera final : public LibraryCamera {
 public:
  /// @param ptp  kept up to date for other threads.
  AravisCamera(std::string_view name, const AravisOptions& options, const ports::SystemClocks& clocks, ports::Log& log,
               std::shared_ptr<std::atomic<PtpState>> ptp);
  ~AravisCamera() override;

  /// Bytes of the buffers that these options need; 0 for options that cannot work.
  static std::size_t buffer_bytes(const AravisOptions& options);

  const char* library() const override { return "Aravis"; }
  Status reserve() override;
  LibraryResult open(Wake& wake) override;
  LibraryResult restart() override;
  void close() override;
  bool poll(LibraryImage& image) override;
  void give_back(int slot) override;
  ports::ImageFault diagnose() override;
  ports::ImageFault look_after(int64_t now_ns) override;
  bool free_running() const override { return options_.trigger == AravisTrigger::kContinuous; }
  bool fire() override;

 private:
  std::size_t slot_bytes() const;
  Result<FoundCamera> find();
  LibraryResult connect(const FoundCamera& found);
  LibraryResult configure();
  LibraryResult stream(Wake& wake);
  void network_options();
  void give_up(bool answers);
  void read_clock();
  void note(std::string_view what, std::string_view why);
  void widen_socket();
  void note_small_socket();

  const AravisOptions options_;
  const ports::SystemClocks& clocks_;
  HealthLog log_;  // for its notes only: what is wrong, the relay tells
  const std::shared_ptr<std::atomic<PtpState>> ptp_;
  const PfncFormat* const format_;

  std::shared_ptr<LockedMemory> memory_;
  AravisConnection connection_;
  std::shared_ptr<AravisShared> last_;  // of the last connection, also where that is being buried
  Burial burial_;
  std::array<ArvBuffer*, kMaxLibraryBuffers> buffers_{};
  Features features_;
  std::optional<sockaddr_in> address_;  // of a GigE Vision camera
  bool answers_ = false;                // as far as is known
  StampContext stamping_;
  BlockNumbers numbers_;
  int64_t ptp_read_ns_ = 0;
  std::size_t socket_bytes_ = 0;  // 0: not known
  bool torn_ = false, torn_told_ = false;
};

}  // namespace roomcal::drivers
