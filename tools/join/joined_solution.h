#pragma once

#include <vector>

#include "runtime/calib/outcome.h"
#include "tools/join/tie.h"

namespace roomcal::tools {

/// What each view of the untied solution says about how it fits, by sighting.
struct ViewFit {
  std::size_t rings = 0;
  bool told = false;  ///< the view that its camera's outcome is told from
};

/// The tied device as a joint solution of one shot, so that all that reads such a one reads this. Owns its memory.
class JoinedSolution {
 public:
  /// @param base   shot whose place in the room it is told at.
  /// @param alone  of all sightings, not tied. @param fits  by sighting.
  /// @param[in,out] outcome  its cameras' `view`, their refined `camera` and its LiDARs' `sensor` are set, and its
  ///                         `solution` shows into this object.
  /// @throws ToolError if refined parameters are no lens.
  void fill(const calib::Device& device, const TieInput& input, const TieSolution& tied, std::size_t base,
            const rig::RigSolution& alone, const std::vector<ViewFit>& fits, calib::Outcome& outcome);

 private:
  void number(const TieInput& input, const TieSolution& tied, std::size_t base, calib::Outcome& outcome);
  void fill_covariance(const TieInput& input, const TieSolution& tied, std::size_t base);
  void fill_fits(const TieInput& input, const rig::RigSolution& alone, const std::vector<ViewFit>& fits);
  void fill_lenses(const calib::Device& device, const TieInput& input, const TieSolution& tied,
                   calib::Outcome& outcome);

  std::vector<std::size_t> units_;       ///< that are known, by their number in the solution
  std::vector<std::size_t> number_of_;   ///< of a unit in the solution; kNone
  std::vector<std::size_t> lens_units_;  ///< whose lens was refined
  std::vector<SE3> T_room_sensor_;
  std::vector<double> cov_room_, rms_px_, chi2_camera_;
  std::vector<uint16_t> outliers_;
  std::vector<rig::RefinedLens> lenses_;
};

}  // namespace roomcal::tools
