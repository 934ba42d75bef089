#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/detector_sweep.h"
#include "tools/evaluate/lidar_trial.h"

namespace roomcal::tools {

/// What the location may use.
enum class LidarAid : uint8_t {
  kPrior,           ///< a pose within 0.2 m and 10 degrees, ranges alone: what the bound knows
  kPriorAndPrints,  ///< and the reflectivity of the printed sheets
  kPrints,          ///< no prior
  kPriorByGicp,     ///< as kPrior, located by scan::locate_by_gicp()
};
const char* to_string(LidarAid aid);

/// Trials of one way to hold the sensor.
struct LidarCell {
  Tilt tilt = Tilt::kUpright;
  LidarAid aid = LidarAid::kPrior;
  int poses = 0;
  int observable = 0;  ///< by the bound
  int found = 0;       ///< of these, located within 30 mm and 0.5 degree in all axes
  int unobservable = 0;
  int missed = 0;                                 ///< of these, located without a word on weak axes and without prints
  int closed = 0;                                 ///< of these, located with all axes fixed by prints
  double closed_squares_m2 = 0, closed_nees = 0;  ///< sums over the closed ones: squared position error, NEES
  int ambiguous = 0, refused = 0, wrong = 0;
  int cautious = 0;  ///< observable by the bound, with an axis reported open by more than three bounds
  double position_squares = 0, rotation_squares = 0;  ///< of error over bound, found poses that are not cautious
  double cautious_squares = 0;                        ///< position, the cautious ones
  double nees = 0;                                    ///< sum over found poses
  std::vector<double> bound_m, bound_rad, error_m, error_rad, ms;

  void add(const LidarTrial& trial);
  int judged() const { return found - cautious; }
  double position_ratio() const;
  double rotation_ratio() const;
  double mean_nees() const;
};

/// What is drawn at random: figures must not hang on it.
struct LidarSeeds {
  uint64_t room = 7;
  uint64_t pose = 1000;  ///< of the first; the others follow
};

/// `poses` for each way to hold the sensor and each aid, on all cores. The same numbers on every machine
/// but for the times; the same sweeps under each aid.
std::vector<LidarCell> run_lidar_cells(const std::vector<LidarAid>& aids, int poses, const LidarSeeds& seeds);

std::vector<Bar> judge_lidar(const std::vector<LidarCell>& cells);

/// Generalized ICP beside locate() on the same sweeps: of kPrior and kPriorByGicp.
std::vector<Bar> judge_gicp(const std::vector<LidarCell>& cells);

}  // namespace roomcal::tools
