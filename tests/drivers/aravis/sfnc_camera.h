#pragma once

#include <string>

namespace roomcal::drivers {

/// A GenICam description, on the registers of Aravis' fake camera, of what that one lacks: a camera as today's standard
/// (SFNC 2) has it, with bounds, two trigger selectors, action commands, chunks, and PTP. Its PTP agrees with a master
/// as soon as it is switched on.
std::string sfnc_camera_xml();

/// The same in a file that goes with this.
class SfncCameraFile {
 public:
  SfncCameraFile();
  ~SfncCameraFile();
  SfncCameraFile(const SfncCameraFile&) = delete;
  SfncCameraFile& operator=(const SfncCameraFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace roomcal::drivers
