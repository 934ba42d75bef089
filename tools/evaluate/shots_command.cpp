#include "tools/evaluate/shots_command.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "tools/evaluate/evaluation_document.h"
#include "tools/evaluate/shots_report.h"

namespace roomcal::tools {

namespace {

struct Arguments {
  int shots = 0, rendered = 0;  ///< 0: not asked for
  uint64_t seed = 1;
  std::filesystem::path document;
};

constexpr int kWholeShots = 10'000, kWholeRendered = 200;  // what the bars are meant of

/// Says so where a run is only a part of what the bars are meant of.
std::string whole_of(const char* option, int count, int whole, uint64_t seed) {
  if (count >= whole) return "";
  return fmt::format(
      "**This is a part:** the bars are meant of {}, which `roomcal evaluate {} {} --seed {}` measures.\n\n", whole,
      option, whole, seed);
}

void publish(const Arguments& arguments, const EvaluationSection& section) {
  if (!arguments.document.empty()) write_section(arguments.document, section);
}

EvaluationSection section_of(uint64_t seed, int shots, const ShotTallies& tallies) {
  return {"shots", "Shots of every kind", fmt::format("roomcal evaluate --shots {} --seed {}", shots, seed),
          fmt::format(
              "{} shots, seed {}, of the paper's robot with two VLP-16 in {} random rooms, simulated at the level of "
              "observations (ring centres with their covariance, LiDAR points). All but clean ones must be refused or "
              "come out right.\n\n{}{}",
              shots, seed, kShotRooms, whole_of("--shots", shots, kWholeShots, seed), report_of(tallies))};
}

// The document has the shots so far: hours of work are not lost with a run that is cut short.
bool observe_shots(const Arguments& arguments) {
  const auto keep = [&](int shots, const ShotTallies& so_far) {
    publish(arguments, section_of(arguments.seed, shots, so_far));
  };
  const ShotTallies tallies = run_observed_shots(arguments.seed, arguments.shots, kShotRooms, keep);
  fmt::print("{}\n", section_of(arguments.seed, arguments.shots, tallies).body);
  return all_met(bars_of(tallies));
}

EvaluationSection section_of(uint64_t seed, int shots, const RenderedTallies& tallies) {
  return {"rendered", "Rendered shots of every kind",
          fmt::format("roomcal evaluate --rendered {} --seed {}", shots, seed),
          fmt::format("{} shots of every kind, seed {}, through images and packets, and the same shots at the level of "
                      "observations.\n\n{}{}",
                      shots, seed, whole_of("--rendered", shots, kWholeRendered, seed), report_of(tallies))};
}

bool render_shots(const Arguments& arguments) {
  const auto keep = [&](int shots, const RenderedTallies& so_far) {
    publish(arguments, section_of(arguments.seed, shots, so_far));
  };
  const RenderedTallies tallies = run_rendered_shots(arguments.seed, arguments.rendered, kShotKinds, keep);
  fmt::print("{}\n", section_of(arguments.seed, arguments.rendered, tallies).body);
  return all_met(bars_of(tallies));
}

}  // namespace

void add_evaluate_shots(CLI::App& evaluate, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::Option* shots =
      evaluate.add_option("--shots", arguments->shots, "clean and adverse shots at the level of observations")
          ->check(CLI::Range(1, 1'000'000));
  CLI::Option* rendered =
      evaluate.add_option("--rendered", arguments->rendered, "shots of every kind through images and packets")
          ->check(CLI::Range(1, 100'000));
  CLI::Option* seed = evaluate.add_option("--seed", arguments->seed, "same seed, same shots")->capture_default_str();
  CLI::Option* document = evaluate.add_option("--document", arguments->document,
                                              "also put the figures into this file's section, EVALUATION.md");
  for (CLI::App* subcommand : evaluate.get_subcommands({}))
    for (CLI::Option* option : {shots, rendered, seed, document}) subcommand->excludes(option);
  evaluate.callback([&evaluate, shots, rendered, arguments, &exit_code] {
    const bool asked = shots->count() + rendered->count() > 0;
    if (!asked && evaluate.get_subcommands().empty()) throw CLI::RequiredError("A subcommand, --shots or --rendered");
    bool good = true;
    if (shots->count() > 0) good = observe_shots(*arguments) && good;
    if (rendered->count() > 0) good = render_shots(*arguments) && good;
    if (asked && !good) exit_code = 2;
  });
}

}  // namespace roomcal::tools
