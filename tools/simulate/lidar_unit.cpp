#include "tools/simulate/lidar_unit.h"

#include <array>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/simulate/ouster_unit.h"
#include "tools/simulate/vlp16_unit.h"
#include "tools/simulate/vlp32c_unit.h"
#include "tools/simulate/xt32_unit.h"

namespace roomcal::tools {

namespace {

using Maker = std::unique_ptr<LidarUnit> (*)(uint64_t unit_seed, double first_turn);

struct Entry {
  const char* name;
  Maker make;
};

constexpr std::array kUnits = {
    Entry{"vlp16",
          [](uint64_t, double turn) -> std::unique_ptr<LidarUnit> { return std::make_unique<Vlp16Unit>(turn); }},
    Entry{"vlp32c",
          [](uint64_t, double turn) -> std::unique_ptr<LidarUnit> { return std::make_unique<Vlp32cUnit>(turn); }},
    Entry{"xt32",
          [](uint64_t seed, double turn) -> std::unique_ptr<LidarUnit> {
            return std::make_unique<Xt32Unit>(seed, turn);
          }},
    Entry{"os0-32",
          [](uint64_t seed, double turn) -> std::unique_ptr<LidarUnit> {
            return std::make_unique<OusterUnit>(kOs0_32, seed, turn);
          }},
    Entry{"os1-64",
          [](uint64_t seed, double turn) -> std::unique_ptr<LidarUnit> {
            return std::make_unique<OusterUnit>(kOs1_64, seed, turn);
          }},
};

}  // namespace

std::string lidar_unit_names() {
  std::string names;
  for (const Entry& entry : kUnits) names += (names.empty() ? "" : ", ") + std::string(entry.name);
  return names;
}

std::unique_ptr<LidarUnit> make_lidar_unit(const std::string& name, uint64_t unit_seed, double first_turn) {
  for (const Entry& entry : kUnits)
    if (name == entry.name) return entry.make(unit_seed, first_turn);
  throw ToolError(fmt::format("LiDAR {}: is not simulated; take one of {}", name, lidar_unit_names()));
}

}  // namespace roomcal::tools
