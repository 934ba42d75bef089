#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/common/progress.h"
#include "tools/evaluate/paper_trial.h"

namespace roomcal::tools {

/// How much is done.
struct PaperOptions {
  int rooms = 8;     ///< that shots are spread over
  int shots = 200;   ///< of each row, at the level of observations
  int pairs = 300;   ///< of stereo images in a survey
  int rendered = 3;  ///< shots of each device through pictures
  int markers = 12;  ///< places where rings and AprilTags are compared
};

/// Rooms that shots are spread over: made once.
class PaperRooms {
 public:
  explicit PaperRooms(int count);
  const TrustRoom& of(uint64_t shot) const { return *rooms_[shot % rooms_.size()]; }

 private:
  std::vector<std::unique_ptr<TrustRoom>> rooms_;
};

/// Shots 1..count of a device, each in its room, on all cores; the same on every machine.
/// @param map_sigma_m  every shot has a map of its own with noise of this much per axis; planes are found again in it.
/// @param declared     whether the map tells so.
std::vector<PaperTrial> run_paper_trials(const PaperRooms& rooms, const std::string& device, int count,
                                         double map_sigma_m = 0, bool declared = true);

/// One pair of sensors over many shots.
struct PaperPair {
  std::string to, from;
  int shots = 0;
  int accepted = 0;  ///< shots with a verdict that may be written and this pair in it
  int wrong = 0;     ///< of these, PairError::wrong()
  std::vector<double> position_m, rotation_rad, seen_position_m, seen_rotation_rad, baseline_m, nees;

  int right() const { return accepted - wrong; }
};
/// @param accepted_only  errors of shots that may be written; else of all in which both sensors were located.
PaperPair pair_over(const std::vector<PaperTrial>& trials, const std::string& to, const std::string& from,
                    bool accepted_only);

}  // namespace roomcal::tools
