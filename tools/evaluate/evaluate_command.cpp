#include "tools/evaluate/evaluate_command.h"

#include "tools/evaluate/anchor_room.h"
#include "tools/evaluate/detector_command.h"
#include "tools/evaluate/lidar_command.h"
#include "tools/evaluate/paper_command.h"
#include "tools/evaluate/rings_command.h"
#include "tools/evaluate/shots_command.h"
#include "tools/evaluate/trust_command.h"

namespace roomcal::tools {

void add_evaluate_command(CLI::App& app, int& exit_code) {
  CLI::App* evaluate = app.add_subcommand("evaluate", "Measure the parts against their bars");
  evaluate->require_subcommand(0, 1);
  add_evaluate_anchor_room(*evaluate, exit_code);
  add_evaluate_detector(*evaluate, exit_code);
  add_evaluate_lidar(*evaluate, exit_code);
  add_evaluate_paper(*evaluate, exit_code);
  add_evaluate_rings(*evaluate);
  add_evaluate_trust(*evaluate, exit_code);
  add_evaluate_shots(*evaluate, exit_code);  // after all subcommands, which its options exclude
}

}  // namespace roomcal::tools
