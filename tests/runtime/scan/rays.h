#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/scan/ray_block.h"
#include "runtime/scan/ray_cast.h"

namespace roomcal::scan::test {

/// One ray, as tests make them.
struct Ray {
  Vec3 direction_lidar = Vec3::UnitX();
  double range_m = 0;
  uint16_t beam = 0;
};

inline std::vector<RayBlock> blocks_of(std::span<const Ray> rays) {
  std::vector<RayBlock> blocks((rays.size() + kBlockRays - 1) / kBlockRays);
  for (RayBlock& block : blocks) block.count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RayBlock& block = blocks[i / kBlockRays];
    const std::size_t k = block.count++;
    block.x[k] = static_cast<float>(rays[i].direction_lidar.x());
    block.y[k] = static_cast<float>(rays[i].direction_lidar.y());
    block.z[k] = static_cast<float>(rays[i].direction_lidar.z());
    block.range_m[k] = static_cast<float>(rays[i].range_m);
    block.beam[k] = rays[i].beam;
    block.reflectivity[k] = 0;
  }
  for (RayBlock& block : blocks) close_block(block);
  return blocks;
}

/// What a single ray meets.
struct Hit {
  int32_t face = kNoFace;
  double range_m = 0;
  bool from_behind = false;
};

inline Hit hit_of(const PosedSurface& posed, const BlockHits& hits, std::size_t i) {
  const int32_t face = hits.face[i];
  if (face == kNoFace) return {};
  return {face, 1 / static_cast<double>(hits.inverse_m[i]), posed.height_m()[static_cast<std::size_t>(face)] < 0};
}

inline Hit cast_one(const PosedSurface& posed, const Vec3& direction_lidar) {
  const Ray ray{direction_lidar, 1, 0};
  BlockHits hits;
  posed.cast(blocks_of({&ray, 1})[0], hits);
  return hit_of(posed, hits, 0);
}

}  // namespace roomcal::scan::test
