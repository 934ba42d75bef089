#include "runtime/scan/ray_block.h"

#include <cmath>

#include "runtime/base/vector_clones.h"

// Compiled as vector code, see CMakeLists.txt.
namespace roomcal::scan {

namespace {

/// Box around the directions of all lanes, those without a ray included.
void find_box(const BlockFloats& along, float& middle, float& reach) {
  constexpr std::size_t kLanes = 16;
  float low[kLanes], high[kLanes];
  for (std::size_t j = 0; j < kLanes; ++j) low[j] = high[j] = along[j];
  for (std::size_t first = kLanes; first < kBlockRays; first += kLanes) {
    for (std::size_t j = 0; j < kLanes; ++j) {
      const float value = along[first + j];
      low[j] = value < low[j] ? value : low[j];
      high[j] = value > high[j] ? value : high[j];
    }
  }
  for (std::size_t j = 1; j < kLanes; ++j) {
    low[0] = low[j] < low[0] ? low[j] : low[0];
    high[0] = high[j] > high[0] ? high[j] : high[0];
  }
  middle = 0.5F * (low[0] + high[0]);
  reach = 0.5F * (high[0] - low[0]) + 1e-6F;  // rounding
}

void find_boxes(RayBlock& block) {
  find_box(block.x, block.middle[0], block.reach[0]);
  find_box(block.y, block.middle[1], block.reach[1]);
  find_box(block.z, block.middle[2], block.reach[2]);
}

void clear_from_count(RayBlock& block) {
  for (std::size_t i = block.count; i < kBlockRays; ++i) {
    block.x[i] = block.y[i] = block.z[i] = block.range_m[i] = 0;
    block.beam[i] = block.reflectivity[i] = 0;
  }
}

/// Points to unit directions and ranges; 0 to 0.
ROOMCAL_VECTOR_CLONES void normalize(RayBlock& block) {
  for (std::size_t i = 0; i < kBlockRays; ++i) {
    const float x = block.x[i], y = block.y[i], z = block.z[i];
    const float range_m = std::sqrt(x * x + y * y + z * z);
    const float inverse = 1.0F / (range_m + 1e-30F);
    block.x[i] = x * inverse;
    block.y[i] = y * inverse;
    block.z[i] = z * inverse;
    block.range_m[i] = range_m;
  }
  find_boxes(block);
}

}  // namespace

BlockReader::BlockReader(const SweepView& view, const SensorModel& sensor, std::size_t stride)
    : view_(view),
      least_m2_(static_cast<float>(sensor.min_range_m * sensor.min_range_m)),
      greatest_m2_(static_cast<float>(sensor.max_range_m * sensor.max_range_m)),
      step_(fair_stride(stride)) {}

bool BlockReader::next(RayBlock& block) {
  std::size_t count = 0;
  while (sweep_ < view_.sweeps.size() && count < kBlockRays) {
    const std::span<const lidar::SweepPoint> points = view_.sweeps[sweep_].points;
    for (; at_ < points.size() && count < kBlockRays; at_ += step_) {
      const lidar::SweepPoint& point = points[at_];
      block.x[count] = point.x_m;
      block.y[count] = point.y_m;
      block.z[count] = point.z_m;
      block.beam[count] = point.beam;
      block.reflectivity[count] = point.reflectivity;
      const float squared = point.x_m * point.x_m + point.y_m * point.y_m + point.z_m * point.z_m;
      // NaN fails both comparisons.
      const bool usable = squared >= least_m2_ && squared <= greatest_m2_ && point.beam < kMaxBeams;
      count += usable ? 1U : 0U;
    }
    if (at_ < points.size()) break;
    at_ -= points.size();
    ++sweep_;
  }
  block.count = static_cast<uint32_t>(count);
  if (count == 0) return false;
  clear_from_count(block);
  normalize(block);
  return true;
}

namespace {

/// Fills blocks with rays spread over the sweeps; empty if the arena is too small, or no point is usable.
std::span<const RayBlock> take_sample(const SweepView& view, const SensorModel& sensor, std::span<RayBlock> blocks) {
  const std::size_t wanted = blocks.size() * kBlockRays;
  if (wanted == 0) return {};
  BlockReader reader(view, sensor, (view.point_count() + wanted - 1) / wanted);
  std::size_t count = 0;
  while (count < blocks.size() && reader.next(blocks[count])) ++count;
  return blocks.first(count);
}

}  // namespace

Status Samples::take(const SweepView& view, const SensorModel& sensor, Arena& scratch, Samples& samples) {
  const std::span<RayBlock> probe = scratch.allocate_uninitialized<RayBlock>(kProbeBlocks);
  const std::span<RayBlock> coarse = scratch.allocate_uninitialized<RayBlock>(kCoarseBlocks);
  const std::span<RayBlock> fine = scratch.allocate_uninitialized<RayBlock>(kFineBlocks);
  if (probe.empty() || coarse.empty() || fine.empty()) {
    return out_of_arena("scan: scratch arena too small for a sample of the sweep");
  }
  samples.probe = take_sample(view, sensor, probe);
  samples.coarse = take_sample(view, sensor, coarse);
  samples.fine = take_sample(view, sensor, fine);
  return ok_status();
}

std::size_t ray_count(std::span<const RayBlock> blocks) {
  std::size_t count = 0;
  for (const RayBlock& block : blocks) count += block.count;
  return count;
}

void close_block(RayBlock& block) {
  clear_from_count(block);
  find_boxes(block);
}

}  // namespace roomcal::scan
