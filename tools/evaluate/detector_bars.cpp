#include <algorithm>
#include <functional>
#include <map>
#include <tuple>

#include <fmt/core.h>

#include "tools/evaluate/detector_sweep.h"

namespace roomcal::tools {

namespace {

constexpr double kRmsRatio = 1.5;
constexpr double kMeanOffset_px = 0.003;
constexpr double kMeanOffsetSigma_px = 0.001;  // a mean that is known worse than this proves nothing
constexpr double kRecall = 0.995;
constexpr double kSlantedRecall = 0.95;

bool in_core(const CellSpec& spec) { return spec.slant_deg <= 45 && spec.diameter_px >= 20 && spec.diameter_px <= 100; }

/// Cells that agree in the key, pooled.
using Key = std::tuple<double, double>;
std::vector<CellResult> pooled(const DetectorSweep& sweep, const std::function<bool(const CellSpec&)>& chosen,
                               const std::function<Key(const CellSpec&)>& key) {
  std::map<Key, std::vector<CellResult>> groups;
  for (const CellResult& cell : sweep.cells) {
    if (chosen(cell.spec)) groups[key(cell.spec)].push_back(cell);
  }
  std::vector<CellResult> sums;
  for (const auto& [unused, cells] : groups) sums.push_back(pool(cells));
  return sums;
}

Bar rms_bar(const DetectorSweep& sweep) {
  const std::string demand = fmt::format("centre RMS <= {} x Cramer-Rao, 20..100 px, slant <= 45 deg", kRmsRatio);
  CellResult worst;
  for (const CellResult& cell : sweep.cells) {
    if (!in_core(cell.spec) || cell.found == 0) continue;
    if (worst.found == 0 || !(cell.ratio() <= worst.ratio())) worst = cell;  // not a number is the worst
  }
  if (worst.found == 0) return {demand, "no marker found", false};
  return {demand,
          fmt::format("at worst {:.2f} x ({} px, {} deg, gradient {}, noise {})", worst.ratio(), worst.spec.diameter_px,
                      worst.spec.slant_deg, worst.spec.gradient, worst.spec.noise_sigma),
          worst.ratio() <= kRmsRatio};
}

/// One direction of light at a time: a fit that is blind to the gradient is off along it.
Bar mean_bar(const DetectorSweep& sweep) {
  const std::string demand =
      fmt::format("mean offset <= {} px at each size and light, 20..100 px, slant <= 45 deg", kMeanOffset_px);
  CellResult worst;
  double sigma_px = 0;
  for (const CellResult& group :
       pooled(sweep, in_core, [](const CellSpec& s) { return Key(s.diameter_px, s.gradient); })) {
    if (!(group.mean_error_px().norm() < worst.mean_error_px().norm())) worst = group;
    sigma_px = std::max(sigma_px, group.mean_error_sigma_px());
  }
  if (worst.found == 0) return {demand, "no marker found", false};
  const Vec2 mean_px = worst.mean_error_px();
  return {
      demand,
      fmt::format("at worst ({:+.4f}, {:+.4f}) px +- {:.4f} ({} px, gradient {}, {} markers)", mean_px.x(), mean_px.y(),
                  worst.mean_error_sigma_px(), worst.spec.diameter_px, worst.spec.gradient, worst.found),
      mean_px.norm() <= kMeanOffset_px && sigma_px <= kMeanOffsetSigma_px};
}

Bar recall_bar(const DetectorSweep& sweep, const std::string& demand, double limit,
               const std::function<bool(const CellSpec&)>& chosen) {
  const auto groups = pooled(sweep, chosen, [](const CellSpec& s) { return Key(s.diameter_px, s.slant_deg); });
  const auto worst = std::min_element(groups.begin(), groups.end(),
                                      [](const CellResult& a, const CellResult& b) { return a.recall() < b.recall(); });
  if (worst == groups.end()) return {demand, "not measured", false};
  return {demand,
          fmt::format("at worst {:.2f} % ({} px, {} deg, {} of {})", 100 * worst->recall(), worst->spec.diameter_px,
                      worst->spec.slant_deg, worst->found, worst->truths),
          worst->recall() >= limit};
}

}  // namespace

std::vector<Bar> judge_sweep(const DetectorSweep& sweep) {
  const CellResult all = pool(sweep.cells);
  return {rms_bar(sweep),
          mean_bar(sweep),
          recall_bar(sweep, fmt::format("recall >= {} % from 15 px, slant <= 45 deg", 100 * kRecall), kRecall,
                     [](const CellSpec& s) { return s.slant_deg <= 45; }),
          recall_bar(sweep, fmt::format("recall >= {} % from 30 px, slant 70 deg", 100 * kSlantedRecall),
                     kSlantedRecall, [](const CellSpec& s) { return s.slant_deg == 70 && s.diameter_px >= 30; }),
          {"no false alarm", fmt::format("{} beside {} markers", all.false_alarms, all.truths), all.false_alarms == 0}};
}

}  // namespace roomcal::tools
