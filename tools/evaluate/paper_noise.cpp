#include "tools/evaluate/paper_noise.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/core.h>

#include "tools/evaluate/paper_figures.h"
#include "tools/evaluate/spread.h"

namespace roomcal::tools {

namespace {

constexpr double kMapSigma_m[] = {0, 0.005, 0.010, 0.015, 0.020};

/// "cam1: 1-sigma of # mm is above # mm": so that reasons can be counted.
std::string without_numbers(const std::string& reason) {
  std::string out;
  for (const char c : reason) {
    const bool number = (c >= '0' && c <= '9') || (c == '.' && out.ends_with('#'));
    const bool in_name = !out.empty() && std::isalpha(static_cast<unsigned char>(out.back())) != 0;
    if (!number || in_name)
      out += c;
    else if (!out.ends_with('#'))
      out += '#';
  }
  return out;
}

std::string most_frequent_refusal(const std::vector<PaperTrial>& trials) {
  std::map<std::string, int> counts;
  for (const PaperTrial& trial : trials)
    if (!trial.accepted()) ++counts[without_numbers(trial.reason)];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? "" : most->first;
}

std::vector<NoiseRow> run_rows(const PaperRooms& rooms, int shots, const std::string& device, const std::string& to,
                               const std::string& from) {
  std::vector<NoiseRow> rows;
  for (const double sigma_m : kMapSigma_m) {
    const std::vector<PaperTrial> trials = run_paper_trials(rooms, device, shots, sigma_m);
    NoiseRow row;
    row.map_sigma_m = sigma_m;
    row.pair = pair_over(trials, to, from, false);
    std::vector<double> bounds;
    for (const PaperTrial& trial : trials) {
      if (trial.find(to, from) == nullptr) continue;
      row.px.push_back(trial.rms_px);
      bounds.push_back(trial.baseline_bound_m);
    }
    row.bound_m = spread_of(bounds).rms;
    row.refusal = most_frequent_refusal(trials);
    rows.push_back(row);
  }
  return rows;
}

void hide_noise(const PaperRooms& rooms, int shots, std::vector<NoiseRow>& stereo) {
  for (NoiseRow& row : stereo) {
    if (row.map_sigma_m <= 0) continue;
    const PaperPair pair =
        pair_over(run_paper_trials(rooms, "stereo_rig", shots, row.map_sigma_m, false), "cam1", "cam0", true);
    row.hidden_accepted = pair.accepted;
    row.hidden_wrong = pair.wrong;
  }
}

const PaperNoiseRow* paper_row(double map_sigma_m) {
  for (const PaperNoiseRow& row : paper_noise_rows())
    if (row.map_sigma_m == map_sigma_m) return &row;
  return nullptr;
}

std::string beyond_paper(double map_sigma_m) { return map_sigma_m > kPaperNoiseLimit_m ? "fails" : "-"; }

/// A figure of the located shots; a dash where there was none.
std::string found(double value, const NoiseRow& row) { return row.pair.nees.empty() ? "-" : figure(value); }

std::string of_shots(int count, const NoiseRow& row) { return fmt::format("{} of {}", count, row.pair.shots); }

/// What refused shots said, and at which noise.
std::string refusals(const std::vector<NoiseRow>& rows) {
  std::map<std::string, std::string> noises_mm;
  for (const NoiseRow& row : rows) {
    if (row.refusal.empty()) continue;
    std::string& noises = noises_mm[row.refusal];
    noises += (noises.empty() ? "" : ", ") + figure(1e3 * row.map_sigma_m);
  }
  std::string text;
  for (const auto& [reason, noises] : noises_mm)
    text += fmt::format(" Refused, mostly, at {} mm: \"{}\".", noises, reason);
  return text;
}

/// The paper's figure is that of one shot: below the bound of the RMS it was luck, and no figure to go by.
std::string luck(const NoiseRow& row, double paper_mm) {
  if (row.bound_m <= 0 || paper_mm >= 1e3 * row.bound_m) return "";
  return fmt::format("; its one shot lies below what any estimate reaches on average, {} mm",
                     figure(1e3 * row.bound_m));
}

void judge(const NoiseRow& row, std::optional<double> paper_mm, double ours_mm, PaperTable& table) {
  table.wrong += row.pair.wrong;
  if (paper_mm && ours_mm >= *paper_mm)
    table.worse.push_back(fmt::format("map noise {} mm: {} mm (paper {}{})", figure(1e3 * row.map_sigma_m),
                                      figure(ours_mm), figure(*paper_mm), luck(row, *paper_mm)));
}

PaperTable stereo_table(const std::vector<NoiseRow>& rows) {
  PaperTable table;
  table.title = "Camera-camera, one image, noisy map";
  table.text =
      "Stereo rig, length of its baseline (120 mm) against the truth; every shot has a map of its own, every marker "
      "off "
      "by the noise per axis, and the map says so. Bound: Cramer-Rao of the baseline's length, poses and markers "
      "unknown. "
      "The paper has one shot a row. Not told: the same shots with maps that claim to be exact.";
  table.text += refusals(rows);
  table.rows.push_back({"map noise mm", "paper mm", "ours mm", "sd", "worst", "RMS", "bound", "RMS / bound", "paper px",
                        "ours px", "located", "accepted", "wrong", "not told: accepted, wrong"});
  for (const NoiseRow& row : rows) {
    std::vector<double> off;
    for (const double error : row.pair.baseline_m) off.push_back(std::abs(error));
    const Spread mm = spread_of(off, 1e3);
    const PaperNoiseRow* paper = paper_row(row.map_sigma_m);
    table.rows.push_back({figure(1e3 * row.map_sigma_m),
                          paper ? figure(1e3 * paper->baseline_error_m) : beyond_paper(row.map_sigma_m),
                          found(mm.mean, row), found(mm.sd, row), found(mm.worst, row), found(mm.rms, row),
                          found(1e3 * row.bound_m, row), row.bound_m > 0 ? figure(mm.rms / (1e3 * row.bound_m)) : "-",
                          paper ? figure(paper->reprojection_px) : "-", found(spread_of(row.px).mean, row),
                          of_shots(static_cast<int>(off.size()), row), of_shots(row.pair.accepted, row),
                          fmt::format("{}", row.pair.wrong),
                          row.map_sigma_m > 0 ? fmt::format("{}, {}", row.hidden_accepted, row.hidden_wrong) : "-"});
    judge(row, paper ? std::optional(1e3 * paper->baseline_error_m) : std::nullopt, mm.mean, table);
  }
  return table;
}

/// @param paper_mm, paper_deg  of a row; nothing where the paper printed none
template <typename PaperMm, typename PaperDeg>
PaperTable lidar_table(const std::vector<NoiseRow>& rows, const std::string& title, const std::string& text,
                       PaperMm paper_mm, PaperDeg paper_deg) {
  PaperTable table{title, text + refusals(rows), {}, {}, 0};
  table.rows.push_back({"map noise mm", "paper mm", "ours mm", "sd", "worst", "paper deg", "ours deg", "worst",
                        "NEES (6)", "located", "accepted", "wrong"});
  for (const NoiseRow& row : rows) {
    const Spread mm = spread_of(row.pair.position_m, 1e3), deg = spread_of(row.pair.rotation_rad, rad_to_deg(1));
    const PaperNoiseRow* paper = paper_row(row.map_sigma_m);
    const std::optional<double> theirs_mm = paper ? paper_mm(*paper) : std::nullopt;
    const std::optional<double> theirs_deg = paper ? paper_deg(*paper) : std::nullopt;
    table.rows.push_back({figure(1e3 * row.map_sigma_m), theirs_mm ? figure(*theirs_mm) : beyond_paper(row.map_sigma_m),
                          found(mm.mean, row), found(mm.sd, row), found(mm.worst, row),
                          theirs_deg ? figure(*theirs_deg) : "-", found(deg.mean, row), found(deg.worst, row),
                          found(spread_of(row.pair.nees).mean, row),
                          of_shots(static_cast<int>(row.pair.nees.size()), row), of_shots(row.pair.accepted, row),
                          fmt::format("{}", row.pair.wrong)});
    judge(row, theirs_mm, mm.mean, table);
  }
  return table;
}

}  // namespace

NoiseStudy run_noise_study(const PaperRooms& rooms, int shots) {
  NoiseStudy study{run_rows(rooms, shots, "stereo_rig", "cam1", "cam0"),
                   run_rows(rooms, shots, "mobile_robot", "lidar0", "cam0"),
                   run_rows(rooms, shots, "backpack", "lidar1", "lidar0")};
  hide_noise(rooms, shots, study.stereo);
  return study;
}

std::vector<PaperTable> noise_tables(const NoiseStudy& study) {
  using Figure = std::optional<double>;
  return {
      stereo_table(study.stereo),
      lidar_table(
          study.camera_lidar, "Camera-LiDAR, one sweep, noisy map",
          "Mobile robot, lidar0 from cam0, all directions. Planes are fitted to the noisy markers, so sweeps suffer "
          "too. Paper: distance from the drawing.",
          [](const PaperNoiseRow& row) { return Figure(1e3 * row.camera_lidar.position_m); },
          [](const PaperNoiseRow& row) { return Figure(rad_to_deg(row.camera_lidar.rotation_rad)); }),
      lidar_table(
          study.lidar_lidar, "LiDAR-LiDAR, one sweep each, noisy map",
          "Backpack, lidar1 from lidar0, all directions; the paper tabulates no rotation here.",
          [](const PaperNoiseRow& row) { return Figure(1e3 * row.lidar_lidar_m); },
          [](const PaperNoiseRow&) { return Figure(); })};
}

}  // namespace roomcal::tools
