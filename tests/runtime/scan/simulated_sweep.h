#pragma once

#include "runtime/scan/refine.h"
#include "tools/evaluate/lidar_trial.h"

namespace roomcal::scan::test {

/// One sweep at a pose of a simulated room.
struct SimulatedSweep {
  SimulatedSweep(const tools::LidarRoom& of, const SE3& at, const tools::SweepFlaws& flaws = {})
      : room(of),
        T_room_lidar(at),
        points(of.simulator().sweep(tools::vlp16_beams(), flaws, at, 5)),
        sweep(points.view()) {}
  SimulatedSweep(const SimulatedSweep&) = delete;
  SimulatedSweep& operator=(const SimulatedSweep&) = delete;

  SweepView view() const { return {{&sweep, 1}}; }
  RefineInput input() const { return {room.surface(), sensor, nullptr, sensor.sigma_m, 0}; }
  double error_m(const RangeState& state) const { return (state.T_room_lidar.t - T_room_lidar.t).norm(); }

  const tools::LidarRoom& room;
  SE3 T_room_lidar;
  tools::SimulatedSweep points;
  lidar::Sweep sweep;
  SensorModel sensor;
};

}  // namespace roomcal::scan::test
