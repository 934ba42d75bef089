#include <exception>
#include <new>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "tools/roomcal/commands.h"

int main(int argc, char** argv) {
  CLI::App app("roomcal: host tools of the on-device calibration runtime", "roomcal");
  app.require_subcommand(1);
  int exit_code = 0;
  roomcal::tools::add_commands(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "roomcal: not enough memory; is an input far larger than it should be?\n");
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "roomcal: {}\n", error.what());
    return 1;
  }
  return exit_code;
}
