#include "tools/evaluate/shots_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "tools/evaluate/evaluation_document.h"

namespace roomcal::tools {

namespace {

constexpr double kCleanBar = 0.995;
constexpr double kLevelsApart = 0.02;     // share of clean shots accepted, rendered against observed
constexpr double kHonestNees[] = {3, 9};  // of rendered cameras and LiDARs: 6 is honest

using Table = std::vector<std::vector<std::string>>;

ShotTally total_of(const ShotTallies& tallies) {
  ShotTally total;
  for (const ShotTally& tally : tallies) {
    total.shots += tally.shots;
    total.accepted += tally.accepted;
    total.wrong += tally.wrong;
    total.worst_sigmas = std::max(total.worst_sigmas, tally.worst_sigmas);
    total.cameras.add(tally.cameras);
    total.lidars.add(tally.lidars);
  }
  return total;
}

const ShotTally& clean_of(const ShotTallies& tallies) { return tallies[static_cast<std::size_t>(ShotKind::kClean)]; }

double share(int part, int whole) { return whole == 0 ? 0 : static_cast<double>(part) / whole; }

double nees(const ExtrinsicErrors& errors) { return errors.count == 0 ? 0 : errors.nees / errors.count; }

std::string rms(const ExtrinsicErrors& errors) {
  if (errors.count == 0) return "";
  return fmt::format("{:.3f} mm, {:.4f} deg", 1e3 * std::sqrt(errors.square_m2 / errors.count),
                     std::sqrt(errors.square_deg2 / errors.count));
}

std::string worst(const ExtrinsicErrors& errors) {
  return errors.count == 0 ? "" : fmt::format("{:.2f} mm, {:.3f} deg", 1e3 * errors.worst_m, errors.worst_deg);
}

std::string nees_text(const ExtrinsicErrors& errors) {
  return errors.count == 0 ? "" : fmt::format("{:.2f}", nees(errors));
}

void add_row(const std::string& name, const ShotTally& tally, Table& table) {
  table.push_back({name, std::to_string(tally.shots), std::to_string(tally.accepted),
                   std::to_string(tally.shots - tally.accepted), std::to_string(tally.wrong), rms(tally.cameras),
                   rms(tally.lidars), nees_text(tally.cameras), nees_text(tally.lidars), worst(tally.lidars)});
}

const std::vector<std::string> kHeading = {"shots",       "number",        "accepted",     "refused",
                                           "wrong",       "cameras (RMS)", "LiDARs (RMS)", "NEES cameras",
                                           "NEES LiDARs", "worst LiDAR"};

std::string refusals(const ShotTallies& tallies) {
  constexpr std::size_t kMost = 4;
  Table table = {{"shots", "refused with", "number"}};
  for (const ShotKind kind : kShotKinds) {
    const auto reasons = tallies[static_cast<std::size_t>(kind)].refusals();
    for (std::size_t i = 0; i < std::min(kMost, reasons.size()); ++i)
      table.push_back({to_string(kind), reasons[i].first, std::to_string(reasons[i].second)});
  }
  return "Reasons of refused shots, the most frequent ones of each kind; a shot may have several:\n\n" +
         markdown_table(table);
}

std::string bars_text(const std::vector<ShotsBar>& bars) {
  Table table = {{"demand", "measured", "met"}};
  for (const ShotsBar& bar : bars) table.push_back({bar.demand, bar.measured, bar.met ? "yes" : "**no**"});
  return markdown_table(table);
}

ShotsBar nothing_wrong(const ShotTally& total) {
  return {fmt::format("nothing wrong is accepted: no extrinsic is off by more than {} mm or {} degree and by more than "
                      "{} of its sigmas",
                      1e3 * kWrong_m, kWrong_deg, kWrongSigmas),
          fmt::format("{} of {} accepted", total.wrong, total.accepted), total.wrong == 0};
}

ShotsBar honest(const char* what, const ExtrinsicErrors& errors) {
  return {fmt::format("rendered {}: NEES of clean shots {} to {}", what, kHonestNees[0], kHonestNees[1]),
          nees_text(errors), nees(errors) > kHonestNees[0] && nees(errors) < kHonestNees[1]};
}

}  // namespace

std::vector<ShotsBar> bars_of(const ShotTallies& observed) {
  const ShotTally& clean = clean_of(observed);
  const double right = share(clean.accepted - clean.wrong, clean.shots);
  return {
      {fmt::format("clean shots accepted and right: {:.1f} %", 100 * kCleanBar),
       fmt::format("{} of {}, {:.2f} %", clean.accepted - clean.wrong, clean.shots, 100 * right), right >= kCleanBar},
      nothing_wrong(total_of(observed))};
}

std::vector<ShotsBar> bars_of(const RenderedTallies& both) {
  const ShotTally &rendered = clean_of(both.rendered), &observed = clean_of(both.observed);
  const double a = share(rendered.accepted, rendered.shots), b = share(observed.accepted, observed.shots);
  return {{fmt::format("clean shots accepted, rendered and observed, no more than {:.0f} % apart", 100 * kLevelsApart),
           fmt::format("{:.1f} %, {:.1f} %", 100 * a, 100 * b), std::abs(a - b) <= kLevelsApart},
          nothing_wrong(total_of(both.rendered)),
          honest("cameras", rendered.cameras),
          honest("LiDARs", rendered.lidars)};
}

bool all_met(const std::vector<ShotsBar>& bars) {
  return std::all_of(bars.begin(), bars.end(), [](const ShotsBar& bar) { return bar.met; });
}

std::string report_of(const ShotTallies& observed) {
  Table table = {kHeading};
  for (const ShotKind kind : kShotKinds) add_row(to_string(kind), observed[static_cast<std::size_t>(kind)], table);
  add_row("all", total_of(observed), table);
  return bars_text(bars_of(observed)) + "\n" + markdown_table(table) + "\n" + refusals(observed);
}

std::string report_of(const RenderedTallies& both) {
  Table table = {kHeading};
  for (const ShotKind kind : kShotKinds) {
    add_row(fmt::format("{}, rendered", to_string(kind)), both.rendered[static_cast<std::size_t>(kind)], table);
    add_row(fmt::format("{}, observed", to_string(kind)), both.observed[static_cast<std::size_t>(kind)], table);
  }
  add_row("all, rendered", total_of(both.rendered), table);
  add_row("all, observed", total_of(both.observed), table);
  return bars_text(bars_of(both)) + "\n" + markdown_table(table) + "\n" + refusals(both.rendered);
}

}  // namespace roomcal::tools
