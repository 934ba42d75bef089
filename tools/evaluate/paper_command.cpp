#include "tools/evaluate/paper_command.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/files.h"
#include "tools/evaluate/evaluation_document.h"
#include "tools/evaluate/paper_devices.h"
#include "tools/evaluate/paper_maps.h"
#include "tools/evaluate/paper_noise.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

struct Arguments {
  PaperOptions options;
  std::vector<std::string> experiments;
  std::string json_file;
  std::filesystem::path document;
};

using Tables = std::vector<PaperTable>;

/// One experiment of the paper, or several that share their shots.
struct Experiment {
  const char* name;
  std::function<Tables(const PaperRooms&, const PaperOptions&)> run;
};

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {
      {"maps",
       [](const PaperRooms& rooms, const PaperOptions& options) -> Tables {
         return {maps_table(rooms.of(0), options.pairs)};
       }},
      {"noise", [](const PaperRooms& rooms,
                   const PaperOptions& options) { return noise_tables(run_noise_study(rooms, options.shots)); }},
      {"devices", [](const PaperRooms& rooms, const PaperOptions& options) -> Tables {
         return {devices_table(rooms, options.shots)};
       }}};
  return all;
}

std::vector<std::string> experiment_names() {
  std::vector<std::string> names;
  for (const Experiment& experiment : experiments()) names.emplace_back(experiment.name);
  return names;
}

Tables measure(const Arguments& arguments) {
  const PaperRooms rooms(arguments.options.rooms);
  Tables tables;
  for (const Experiment& experiment : experiments()) {
    const auto& wanted = arguments.experiments;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), experiment.name) == wanted.end()) continue;
    Tables more = experiment.run(rooms, arguments.options);
    std::move(more.begin(), more.end(), std::back_inserter(tables));
  }
  return tables;
}

std::string judgement(const Tables& tables) {
  std::string worse;
  int wrong = 0;
  for (const PaperTable& table : tables) {
    wrong += table.wrong;
    for (const std::string& line : table.worse) worse += fmt::format("- {}: {}\n", table.title, line);
  }
  return fmt::format("### Where ours is not better\n\n{}\nWrong extrinsics that would be written: {}.\n",
                     worse.empty() ? "Nowhere.\n" : worse, wrong);
}

std::string markdown(const Tables& tables) {
  std::string text;
  for (const PaperTable& table : tables)
    text += fmt::format("### {}\n\n{}\n\n{}\n", table.title, table.text, markdown_table(table.rows));
  return text + judgement(tables);
}

json to_json(const Tables& tables) {
  json all = json::array();
  for (const PaperTable& table : tables)
    all.push_back({{"title", table.title}, {"rows", table.rows}, {"worse", table.worse}, {"wrong", table.wrong}});
  return all;
}

void evaluate_paper(const Arguments& arguments, int& exit_code) {
  const Tables tables = measure(arguments);
  const std::string body = markdown(tables);
  fmt::print("{}", body);
  if (!arguments.json_file.empty()) write_atomic(arguments.json_file, to_json(tables).dump(1) + "\n");
  if (!arguments.document.empty())
    write_section(arguments.document, {"paper", "The paper's experiments",
                                       fmt::format("roomcal evaluate paper --shots {} --pairs {}",
                                                   arguments.options.shots, arguments.options.pairs),
                                       body});
  const auto bad = [](const PaperTable& table) { return table.wrong > 0 || !table.worse.empty(); };
  if (std::any_of(tables.begin(), tables.end(), bad)) exit_code = 2;
}

}  // namespace

void add_evaluate_paper(CLI::App& evaluate, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* paper = evaluate.add_subcommand("paper", "the paper's experiments, with truth, beside its figures");
  paper->add_option("--shots", arguments->options.shots, "of each row")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  paper->add_option("--pairs", arguments->options.pairs, "of stereo images in a survey")
      ->check(CLI::Range(20, 10000))
      ->capture_default_str();
  CLI::Option* some = paper->add_option("--experiments", arguments->experiments, "only these; default: all")
                          ->delimiter(',')
                          ->check(CLI::IsMember(experiment_names()));
  paper->add_option("--document", arguments->document, "put the section into this file (EVALUATION.md)")
      ->excludes(some);
  paper->add_option("--json", arguments->json_file, "write the tables to this file");
  paper->callback([arguments, &exit_code] { evaluate_paper(*arguments, exit_code); });
}

}  // namespace roomcal::tools
