#include "tools/simulate/simulate_command.h"

#include "tools/simulate/room_command.h"
#include "tools/simulate/shot_command.h"

namespace roomcal::tools {

void add_simulate_command(CLI::App& app, int& exit_code) {
  static_cast<void>(exit_code);  // makes things, judges nothing
  CLI::App* simulate = app.add_subcommand("simulate", "make a room and shots in it, with known truth");
  simulate->require_subcommand(1);
  add_room_command(*simulate);
  add_shot_command(*simulate);
}

}  // namespace roomcal::tools
