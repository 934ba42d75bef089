#include <cstdio>
#include <memory>

#include "board/common/supervisor.h"

int main(int argc, char** argv) {
  using namespace roomcal::board;
  std::string error;
  const Options options = parse_options(argc, argv, error);
  if (!error.empty()) {
    std::fprintf(stderr, "roomcald: %s\n", error.c_str());
    return 2;
  }
  if (options.help) {
    std::fputs(help_text().c_str(), stdout);
    return 0;
  }
  if (options.version) {
    std::printf("%.*s\n", static_cast<int>(kFirmware.size()), kFirmware.data());
    return 0;
  }
  catch_signals();
  const auto supervisor = std::make_unique<Supervisor>(options);
  if (options.memory_plan) return supervisor->print_memory_plan();
  if (options.check) return supervisor->check();
  if (options.bench_runs > 0) return supervisor->bench();
  return supervisor->run();
}
