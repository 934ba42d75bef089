#include "tools/report/report_command.h"

#include <memory>
#include <string>

#include <fmt/core.h>

#include "tools/common/files.h"
#include "tools/report/report_page.h"

namespace roomcal::tools {

void add_report_command(CLI::App& app, int& /*exit_code*/) {
  struct Options {
    ReportInput input;
    std::string output;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("report", "a calibration as one HTML page: 3-D, images, residuals, sigmas");
  ReportInput& input = options->input;
  command->add_option("result", input.result, "result of `roomcal calibrate --detail --json`, or a record")->required();
  command->add_option("--shot", input.shot, "the shot's folder: for its images and sweeps");
  command->add_option("--map", input.map, "the map it was calibrated with: for the room, and the sweeps' residuals");
  command->add_option("--installed", input.installed, "record or result in force: how far each sensor is from it");
  command->add_option("--truth", input.truth, "truth.json of a simulated shot: errors beside sigmas");
  command->add_option("-o,--output", options->output, "the page to write")->required();
  command->callback([options] {
    const ReportPage page = report_page(options->input);
    for (const std::string& note : page.notes) fmt::print(stderr, "roomcal: {}\n", note);
    write_atomic(options->output, page.html);
    fmt::print("{}: {:.1f} MB, opens in any browser, needs no network\n", options->output,
               1e-6 * static_cast<double>(page.html.size()));
  });
}

}  // namespace roomcal::tools
