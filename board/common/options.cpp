#include "board/common/options.h"

#include <cstdlib>

#include "board/common/boards.h"

namespace roomcal::board {

namespace {

std::string board_names() {
  std::string names;
  for (const Capacities* board : known_boards()) names += (names.empty() ? "" : ", ") + std::string(board->name);
  return names;
}

}  // namespace

Options parse_options(int argc, const char* const* argv, std::string& error) {
  Options options;
  error.clear();
  for (int i = 1; i < argc && error.empty(); ++i) {
    const std::string_view word = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 < argc) return argv[++i];
      error = std::string(word) + ": a value is missing";
      return {};
    };
    if (word == "--board") {
      const std::string name = value();
      options.board = find_board(name);
      if (options.board == nullptr && error.empty()) error = "--board " + name + ": known are " + board_names();
    } else if (word == "--folder") {
      options.folder = value();
    } else if (word == "--console") {
      options.console = value();
    } else if (word == "--state") {
      options.state_folder = value();
    } else if (word == "--memory-plan") {
      options.memory_plan = true;
    } else if (word == "--check") {
      options.check = true;
    } else if (word == "--bench") {
      const std::string runs = value();
      options.bench_runs = std::atoi(runs.c_str());
      if (options.bench_runs < 1 && error.empty()) error = "--bench " + runs + ": how many runs? 100 tell enough";
    } else if (word == "--version") {
      options.version = true;
    } else if (word == "--help" || word == "-h") {
      options.help = true;
    } else {
      error = std::string(word) + ": not an option; see roomcald --help";
    }
  }
  if (error.empty() && options.board == nullptr && !options.help && !options.version)
    error = "--board is missing: one of " + board_names();
  return options;
}

std::string help_text() {
  std::string text =
      "roomcald: the program on the device. It waits for the button, calibrates, and keeps the result.\n"
      "\n"
      "  --board NAME      which product this is:\n";
  for (const Capacities* board : known_boards())
    text += "                      " + std::string(board->name) + ": " + std::string(board->what) + "\n";
  text +=
      "  --folder DIR      device.profile, room.room and factory.record (roomcal provision); paths of the profile\n"
      "                    without a leading slash are below it. Default /etc/roomcal\n"
      "  --console PATH    serial line of the console instead of the profile's; - is standard input and output\n"
      "  --state DIR       where unfinished starts are counted. Default: where the store's file is\n"
      "  --memory-plan     print what would be reserved, and end\n"
      "  --check           arm, say how it went, and end: 0 armed, 1 not\n"
      "  --bench RUNS      verify so many times, print times, memory and extrinsics, and end; nothing is stored\n"
      "  --version, --help\n";
  return text;
}

}  // namespace roomcal::board
