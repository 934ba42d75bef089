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

void publish(const Arguments& arguments, const EvaluationSection& section) {
  fmt::print("{}\n", section.body);
  if (!arguments.document.empty()) write_section(arguments.document, section);
}

bool observe_shots(const Arguments& arguments) {
  const ShotTallies tallies = run_observed_shots(arguments.seed, arguments.shots);
  publish(arguments,
          {"shots", "Shots of every kind",
           fmt::format("roomcal evaluate --shots {} --seed {}", arguments.shots, arguments.seed),
           fmt::format(
               "{} shots, seed {}, of the paper's robot with two VLP-16 in 24 random rooms, simulated at the level of "
               "observations (ring centres with their covariance, LiDAR points). All but clean ones must be refused or "
               "come out right.\n\n{}",
               arguments.shots, arguments.seed, report_of(tallies))});
  return all_met(bars_of(tallies));
}

bool render_shots(const Arguments& arguments) {
  const RenderedTallies tallies = run_rendered_shots(arguments.seed, arguments.rendered);
  publish(
      arguments,
      {"rendered", "Rendered shots of every kind",
       fmt::format("roomcal evaluate --rendered {} --seed {}", arguments.rendered, arguments.seed),
       fmt::format("{} shots of every kind, seed {}, through images and packets, and the same shots at the level of "
                   "observations.\n\n{}",
                   arguments.rendered, arguments.seed, report_of(tallies))});
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
