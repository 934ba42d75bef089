#include "tools/evaluate/paper_devices.h"

#include <fmt/core.h>

#include "tools/evaluate/paper_figures.h"
#include "tools/evaluate/spread.h"

namespace roomcal::tools {

namespace {

std::vector<std::string> sensor_names(const PaperDevice& device) {
  std::vector<std::string> names;
  for (const DeviceCamera& camera : device.cameras) names.push_back(camera.name);
  for (const DeviceLidar& lidar : device.lidars) names.push_back(lidar.name);
  return names;
}

void compare(const std::string& row, const char* unit, double paper, double ours, PaperTable& table) {
  if (ours >= paper) table.worse.push_back(fmt::format("{}: {} {} (paper {})", row, figure(ours), unit, figure(paper)));
}

void add_pair(const PaperDevice& device, const PaperPair& pair, PaperTable& table) {
  const Spread mm = spread_of(pair.position_m, 1e3), deg = spread_of(pair.rotation_rad, rad_to_deg(1));
  const auto paper = paper_distance(device, pair.to, pair.from);
  const std::string name = fmt::format("{} {} <- {}", device.name, pair.to, pair.from);
  table.rows.push_back(
      {device.name, fmt::format("{} <- {}", pair.to, pair.from), paper ? figure(1e3 * paper->position_m) : "-",
       figure(mm.mean), figure(mm.sd), figure(mm.worst), paper ? figure(rad_to_deg(paper->rotation_rad)) : "-",
       figure(deg.mean), figure(deg.sd), figure(deg.worst), figure(spread_of(pair.nees).mean),
       fmt::format("{} of {}", pair.right(), pair.shots), paper ? times_smaller(1e3 * paper->position_m, mm.mean) : "-",
       paper ? times_smaller(rad_to_deg(paper->rotation_rad), deg.mean) : "-"});
  table.wrong += pair.wrong;
  if (!paper) return;
  compare(name, "mm", 1e3 * paper->position_m, mm.mean, table);
  compare(name, "deg", rad_to_deg(paper->rotation_rad), deg.mean, table);
}

}  // namespace

PaperTable devices_table(const PaperRooms& rooms, int shots) {
  PaperTable table;
  table.title = "Four devices, every pair, one shot";
  table.text = fmt::format(
      "{} shots of each device, each with lenses, mounting and place of its own, rings with the noise that the "
      "detector leaves in rendered pictures, "
      "LiDARs as packets with beam offsets, the map exact. Paper: distance of its single result from the drawing. "
      "Ours: "
      "distance from the truth, all directions, also those that a sweep does not see and the mounting carries. "
      "Success: "
      "accepted and not wrong (5 predicted sigmas, and 3 mm or 0.1 degree).",
      shots);
  table.rows.push_back({"device", "pair", "paper mm", "ours mm", "sd", "worst", "paper deg", "ours deg", "sd", "worst",
                        "NEES (6)", "success", "mm", "deg"});
  for (const PaperDevice& device : known_devices()) {
    const std::vector<PaperTrial> trials = run_paper_trials(rooms, device.name, shots);
    const std::vector<std::string> names = sensor_names(device);
    for (std::size_t from = 0; from < names.size(); ++from)
      for (std::size_t to = from + 1; to < names.size(); ++to)
        add_pair(device, pair_over(trials, names[to], names[from], true), table);
  }
  return table;
}

}  // namespace roomcal::tools
