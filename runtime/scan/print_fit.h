#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/scan/range_problem.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

/// What the reflectivities of a sweep say about a shift of its pose along one axis of the room.
struct PrintFit {
  double shift_m = 0;  ///< where sheets and returns match best
  double sigma_m = 0;  ///< of the shift
  double gain = 0;     ///< squares explained by prints at `shift_m`, in variances of what is left; chi-square-like
  bool informative = false;          ///< the map has prints, and reflectivities differ
  bool clear = false;                ///< the match is significant, and no other shift within reach comes near it
  uint32_t points = 0;               ///< on or near a print
  Vec3 centre_lidar = Vec3::Zero();  ///< mean of these: where the shift was measured
};

/// Matches reflectivities with the printed rings of the map.
///
/// Reflectivities are explained by one level for each face and one for each of 12 annuli, common to all prints: neither
/// ink, paper nor ring ratios need be known, only that all prints are alike. The pose is moved along the axis with the
/// faces held (the axis is one that ranges do not fix); the shift that leaves least unexplained is the answer, and the
/// curvature there its sigma.
class PrintMatcher {
 public:
  static constexpr double kSignificant = 100;  ///< gain of a match; a wrong pose reaches some tens by chance

  /// @return kOutOfMemory. Scratch: bytes().
  static Status build(Arena& scratch, PrintMatcher& matcher);
  static std::size_t bytes();

  /// @param axis_room  unit. @param reach_m  to both sides; 0: only the gain at the state itself.
  /// Cost: 1 to 2 ms.
  PrintFit fit(const Surface& surface, const SweepView& view, const SensorModel& sensor, const RangeState& state,
               const Vec3& axis_room, double reach_m);

 private:
  static constexpr std::size_t kCoarsePoints = 2048;
  static constexpr std::size_t kFinePoints = 8192;
  static constexpr std::size_t kAnnuli = 12;
  /// A return on its face, and how it moves there with the shift.
  struct Spot {
    std::array<float, 3> p_room, slide;
    float reflectivity;
    uint16_t face;
  };
  struct Explained {
    double left = 0, total = 0;  ///< squares with and without prints
    std::size_t count = 0;
    std::size_t near = 0;
  };
  /// Shifts that are asked together: first_m + k step_m.
  struct Shifts {
    double first_m = 0, step_m = 0;
    std::size_t count = 0;
    double at(std::size_t k) const { return first_m + step_m * static_cast<double>(k); }
  };
  static constexpr std::size_t kMaxShifts = 2 * 70 + 1;  ///< a metre to each side
  /// Reflectivities that one level explains.
  struct Level {
    double sum = 0, count = 0;
    void add(double value) {
      sum += value;
      ++count;
    }
    double explained() const { return count == 0 ? 0 : sum * sum / count; }
  };
  /// Levels at one shift.
  struct AtShift {
    std::array<Level, kAnnuli> annuli{};
    Level near_face;         ///< on prints of the face that is being gone through
    uint32_t last_spot = 0;  ///< that counted here: none counts twice where prints come close to each other
  };

  std::size_t take(const Surface& surface, const SweepView& view, const SensorModel& sensor, const RangeState& state,
                   const Vec3& axis_room, std::size_t stride, double near_shift_m, bool near_only,
                   std::span<Spot> spots, Vec3& sum_room);
  void explain(const Surface& surface, std::span<const Spot> spots, const Shifts& shifts,
               std::span<Explained> explained);
  void add_spot(const Surface& surface, const Spot& spot, uint32_t number, const Shifts& shifts);
  void add_print(const Spot& spot, const Print& print, uint32_t number, const Shifts& shifts);
  void find_best(const Surface& surface, std::span<const Spot> spots, const Shifts& shifts, PrintFit& fit);
  void polish(const Surface& surface, std::span<const Spot> spots, PrintFit& fit);

  std::span<Spot> coarse_, fine_;
  std::span<AtShift> at_shift_;
};

}  // namespace roomcal::scan
