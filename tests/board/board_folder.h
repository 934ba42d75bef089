#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "runtime/profile/profile.h"
#include "tools/simulate/scene.h"
#include "tools/simulate/stand.h"

namespace roomcal::board::test {

/// A device's folder as `roomcal provision` leaves it, in a temporary place that goes with it: replayed cameras whose
/// pictures are a fraction of the real ones.
class BoardFolder {
 public:
  /// @param device  of the simulator: "mobile_robot", ... @param scale  of its cameras.
  BoardFolder(const std::string& device, double scale, int markers);
  ~BoardFolder();
  BoardFolder(const BoardFolder&) = delete;
  BoardFolder& operator=(const BoardFolder&) = delete;

  /// Writes device.profile and factory.record as profile() is now.
  void provision() const;
  /// Renders the cameras' pictures; where they are not looked at, grey ones do.
  void render_pictures() const;

  profile::Profile& profile() { return profile_; }
  const tools::Scene& scene() const { return scene_; }
  const tools::Stand& stand() const { return stand_; }
  std::string path() const { return path_.string(); }

 private:
  void write_grey_pictures() const;
  void write_recordings() const;

  std::filesystem::path path_;
  tools::Scene scene_;
  tools::ShotOptions options_;
  tools::Stand stand_;
  profile::Profile profile_;
};

}  // namespace roomcal::board::test
