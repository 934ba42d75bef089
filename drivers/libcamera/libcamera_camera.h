#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <libcamera/libcamera.h>

#include "drivers/image/health_log.h"
#include "drivers/libcamera/completions.h"
#include "drivers/libcamera/libcamera_options.h"
#include "drivers/libcamera/mapped_luma.h"
#include "drivers/relay/library_camera.h"
#include "runtime/ports/log.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

/// A camera by libcamera, 0.0.3 (Debian 12) to 0.7.
class LibcameraCamera final : public LibraryCamera {
 public:
  LibcameraCamera(std::string_view name, const LibcameraOptions& options, const ports::SystemClocks& clocks,
                  ports::Log& log);
  ~LibcameraCamera() override { LibcameraCamera::close(); }

  const char* library() const override { return "libcamera"; }
  Status reserve() override;
  LibraryResult open(Wake& wake) override;
  LibraryResult restart() override;
  void close() override;
  bool poll(LibraryImage& image) override;
  void give_back(int slot) override;
  ports::ImageFault diagnose() override;
  ports::ImageFault look_after(int64_t now_ns) override;
  bool free_running() const override { return true; }
  bool fire() override { return false; }

 private:
  LibraryResult acquire();
  LibraryResult configure();
  bool choose_output();
  bool offers(libcamera::StreamRole role, PixelFormat wanted, std::string& seen);
  LibraryResult allocate();
  LibraryResult run();
  void stop();
  void queue(std::size_t slot, const libcamera::ControlList* controls);
  void fill(const Completion& completion, LibraryImage& image);
  void note(std::string_view what, std::string_view why);

  const LibcameraOptions options_;
  const ports::SystemClocks& clocks_;
  HealthLog log_;  // for its notes only: what is wrong, the relay tells

  std::shared_ptr<libcamera::CameraManager> manager_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;  // the index is the slot
  std::array<MappedLuma, kMaxLibraryBuffers> maps_;
  Completions completions_;
  libcamera::ControlList controls_;
  PixelFormat layout_ = PixelFormat::kCount;
  bool running_ = false;
  bool cancel_told_ = false;
};

}  // namespace roomcal::drivers
