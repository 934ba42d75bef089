#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/scan/sensor_model.h"
#include "runtime/scan/sweep_view.h"

namespace roomcal::scan {

inline constexpr std::size_t kBlockRays = 64;
using BlockFloats = std::array<float, kBlockRays>;

/// Rays side by side, in the order of firing: where each beam went and how far it came. Lanes from `count` on are zeros
/// and meet nothing.
///
/// Directions and ranges are floats: at 5 m that is half a micrometre, and errors of single rays average out.
struct RayBlock {
  alignas(64) BlockFloats x, y, z;  ///< unit direction, lidar frame
  alignas(64) BlockFloats range_m;
  std::array<uint16_t, kBlockRays> beam, reflectivity;
  std::array<float, 3> middle, reach;  ///< the box around the directions: middle +- reach
  uint32_t count = 0;

  Vec3 direction_lidar(std::size_t i) const {
    return Vec3(static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i]));
  }
};

/// Reads the usable points of joined sweeps, block by block.
///
/// Not usable: not finite, nearer or farther than the sensor measures, or of a beam that we have no place for. The
/// range is taken from the point itself, so a sensor whose beams start off its origin by centimetres is served too.
class BlockReader {
 public:
  /// @param stride  every which point; made fair, see fair_stride().
  BlockReader(const SweepView& view, const SensorModel& sensor, std::size_t stride);

  /// @return false when no usable point is left; the block is then empty.
  /// Cost: some 3 ns a point.
  bool next(RayBlock& block);

 private:
  SweepView view_;
  float least_m2_, greatest_m2_;
  std::size_t step_;
  std::size_t sweep_ = 0, at_ = 0;
};

/// Calls visit(block) for all blocks of every stride-th point.
template <typename Visit>
void for_each_block(const SweepView& view, const SensorModel& sensor, std::size_t stride, const Visit& visit) {
  BlockReader reader(view, sensor, stride);
  RayBlock block;
  while (reader.next(block)) visit(block);
}

/// Rays spread over the joined sweeps, in three densities.
struct Samples {
  static constexpr std::size_t kProbeBlocks = 3, kCoarseBlocks = 10, kFineBlocks = 32;
  static constexpr std::size_t kMaxRays = kFineBlocks * kBlockRays;  ///< of the densest

  std::span<const RayBlock> probe;   ///< 192 rays at most: to score thousands of poses
  std::span<const RayBlock> coarse;  ///< 640: to bring a pose near
  std::span<const RayBlock> fine;    ///< 2048: to judge one

  /// @return kOutOfMemory.
  static Status take(const SweepView& view, const SensorModel& sensor, Arena& scratch, Samples& samples);
  static constexpr std::size_t bytes() {
    return (kProbeBlocks + kCoarseBlocks + kFineBlocks) * sizeof(RayBlock) + 3 * alignof(RayBlock);
  }
};

std::size_t ray_count(std::span<const RayBlock> blocks);

/// Sets the box around the directions and clears the lanes from `count` on: for blocks that are filled by hand.
void close_block(RayBlock& block);

}  // namespace roomcal::scan
