#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/calib/session.h"
#include "tools/join/joined_solution.h"
#include "tools/join/tie.h"

namespace roomcal::tools {

/// Several shots of one device, joined into one solution of its extrinsics.
///
/// Every shot is calibrated alone and added; join() solves all of them with one map, whose errors they share, and ties
/// them together (tie.h). A sensor that one shot does not locate may come from another one; a direction that a LiDAR
/// does not see from here may be seen from there; a lens that is refined along is the same in all shots.
class ShotJoiner {
 public:
  /// @param session  that the shots are calibrated with; must outlive the joiner.
  explicit ShotJoiner(const calib::Session& session) : session_(session) {}

  /// Copies what a calibrated shot leaves; the step arena may then be rewound.
  void add(const std::string& name, const calib::Outcome& outcome);

  /// The joined outcome, judged as a shot's, and in words what joining itself has to say. Poses in the room are those
  /// of the first shot that takes part; what a camera saw is told from the shot with most of its markers. Verdict: the
  /// gates' on the joined extrinsics; FAIL_SERVICE also where the shots contradict each other beyond
  /// Limits::moved_p_value (the sensor that does so is named), or where one of them alone is FAIL_SERVICE.
  /// Valid until the joiner goes. @throws ToolError if shots are too many for one problem or leave nothing to join.
  const calib::Outcome& join();

  /// By which the shots contradict each other: P(chi-square > chi2).
  double p_value() const { return p_value_; }
  std::size_t shots() const { return shots_.size(); }

 private:
  /// A shot's outcome with memory of its own.
  struct Kept {
    std::string name;
    calib::Outcome outcome;
    std::vector<std::vector<marker::Detection>> detections;
    std::vector<std::vector<pose::Correspondence>> inliers;
    std::vector<std::vector<rig::RingObservation>> rings;
    std::vector<std::vector<rig::PlanePull>> pulls;
  };
  /// All shots' sensors in one problem: a view is a camera in a shot.
  struct Views {
    std::vector<rig::CameraView> cameras;
    std::vector<rig::LidarView> lidars;
    std::vector<Sighting> sightings;  ///< without poses; cameras, then LiDARs, as solve_rig() numbers them
  };

  Views collect() const;
  void solve_alone(const Views& views);
  TieInput tie_input(const Views& views) const;
  std::size_t views_of(std::size_t camera) const;
  std::size_t fullest_shot(std::size_t camera) const;
  std::vector<ViewFit> fits(const Views& views) const;
  std::size_t first_placed(const TieSolution& tied) const;
  void fill(const TieInput& input, const TieSolution& tied, const std::vector<ViewFit>& fits);
  void fill_camera(std::size_t i, std::size_t base, const TieSolution& tied);
  void fill_lidar(std::size_t i, std::size_t base, const TieSolution& tied);
  void judge_joining(const TieInput& input, const TieSolution& tied);

  const calib::Session& session_;
  std::vector<std::unique_ptr<Kept>> shots_;
  std::vector<rig::Landmark> landmarks_;
  std::vector<Mat33> plane_cov_;

  std::vector<std::byte> step_bytes_;
  rig::RigSolution alone_;  ///< of all views, not yet tied

  std::unique_ptr<calib::Outcome> joined_;
  JoinedSolution solution_;
  double p_value_ = 1;
};

}  // namespace roomcal::tools
