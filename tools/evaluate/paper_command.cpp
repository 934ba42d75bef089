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
#include "tools/evaluate/noise_picture.h"
#include "tools/evaluate/paper_devices.h"
#include "tools/evaluate/paper_maps.h"
#include "tools/evaluate/paper_markers.h"
#include "tools/evaluate/paper_noise.h"
#include "tools/evaluate/paper_rendered.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

struct Arguments {
  PaperOptions options;
  std::vector<std::string> experiments;
  std::string json_file;
  std::filesystem::path document, picture;
};

using Tables = std::vector<PaperTable>;

/// One experiment of the paper, or several that share their shots.
struct Experiment {
  const char* name;
  std::function<Tables(const PaperRooms&, const Arguments&)> run;
};

Tables run_noise(const PaperRooms& rooms, const Arguments& arguments) {
  const NoiseStudy study = run_noise_study(rooms, arguments.options.shots);
  Tables tables = noise_tables(study);
  if (arguments.picture.empty()) return tables;
  if (arguments.picture.has_parent_path()) make_folder(arguments.picture.parent_path());
  write_atomic(arguments.picture, noise_picture(study));
  const std::filesystem::path from = arguments.document.parent_path();
  tables[0].text += fmt::format("\n\n![Error against map noise](<{}>)",
                                arguments.picture.lexically_relative(from.empty() ? "." : from).generic_string());
  return tables;
}

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {
      {"maps",
       [](const PaperRooms& rooms, const Arguments& of) -> Tables {
         return {maps_table(rooms.of(0), of.options.pairs)};
       }},
      {"noise", run_noise},
      {"devices",
       [](const PaperRooms& rooms, const Arguments& of) -> Tables { return {devices_table(rooms, of.options.shots)}; }},
      {"rendered",
       [](const PaperRooms& rooms, const Arguments& of) -> Tables {
         return {rendered_table(rooms.of(0), of.options.rendered)};
       }},
      {"markers", [](const PaperRooms& rooms, const Arguments& of) -> Tables {
         return {markers_table(rooms.of(0), of.options.markers)};
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
    Tables more = experiment.run(rooms, arguments);
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

std::string command_line(const PaperOptions& options) {
  return fmt::format("roomcal evaluate paper --rooms {} --shots {} --pairs {} --rendered {} --markers {}",
                     options.rooms, options.shots, options.pairs, options.rendered, options.markers);
}

void evaluate_paper(const Arguments& arguments, int& exit_code) {
  const Tables tables = measure(arguments);
  const std::string body = markdown(tables);
  fmt::print("{}", body);
  if (!arguments.json_file.empty()) write_atomic(arguments.json_file, to_json(tables).dump(1) + "\n");
  if (!arguments.document.empty())
    write_section(arguments.document, {"paper", "The paper's experiments", command_line(arguments.options), body});
  const auto bad = [](const PaperTable& table) { return table.wrong > 0 || !table.worse.empty(); };
  if (std::any_of(tables.begin(), tables.end(), bad)) exit_code = 2;
}

}  // namespace

void add_evaluate_paper(CLI::App& evaluate, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* paper = evaluate.add_subcommand("paper", "the paper's experiments, with truth, beside its figures");
  const auto count = [&](const char* name, int& value, const char* what, int least) {
    paper->add_option(name, value, what)->check(CLI::Range(least, 100000))->capture_default_str();
  };
  count("--rooms", arguments->options.rooms, "that shots are spread over", 1);
  count("--shots", arguments->options.shots, "of each row, from rings and packets", 1);
  count("--pairs", arguments->options.pairs, "of stereo images in a survey", 20);
  count("--rendered", arguments->options.rendered, "shots of each device through pictures", 1);
  count("--markers", arguments->options.markers, "places where rings and AprilTags are compared", 1);
  CLI::Option* some = paper->add_option("--experiments", arguments->experiments, "only these; default: all")
                          ->delimiter(',')
                          ->check(CLI::IsMember(experiment_names()));
  paper->add_option("--document", arguments->document, "put the section into this file (EVALUATION.md)")
      ->excludes(some);
  paper->add_option("--picture", arguments->picture, "draw error against map noise into this file (SVG)");
  paper->add_option("--json", arguments->json_file, "write the tables to this file");
  paper->callback([arguments, &exit_code] { evaluate_paper(*arguments, exit_code); });
}

}  // namespace roomcal::tools
