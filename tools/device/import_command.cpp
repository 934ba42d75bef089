#include "tools/device/import_command.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "tools/common/files.h"
#include "tools/device/device_yaml.h"
#include "tools/device/kalibr.h"
#include "tools/device/nominal.h"

namespace roomcal::tools {

namespace {

struct Arguments {
  std::filesystem::path camchain, nominal, out;
};

void run_kalibr(const Arguments& arguments) {
  Device device = parse_kalibr(arguments.camchain.string(), read_text(arguments.camchain));
  device.name = arguments.out.stem().string();
  if (!arguments.nominal.empty()) apply_nominal(arguments.nominal.string(), read_text(arguments.nominal), device);
  const std::string text = to_device_yaml(device);
  parse_device_yaml(arguments.out.string(), text);  // what we write, we read
  write_atomic(arguments.out, text);
  const auto cameras = std::count_if(device.sensors.begin(), device.sensors.end(),
                                     [](const Sensor& sensor) { return sensor.kind == SensorKind::kCamera; });
  fmt::print("{}: {}, {} cameras, {} LiDARs, rig frame {}\n", arguments.out.string(), device.name, cameras,
             device.sensors.size() - static_cast<std::size_t>(cameras), device.rig_frame);
}

}  // namespace

void add_import_command(CLI::App& app, int& exit_code) {
  static_cast<void>(exit_code);
  CLI::App* import = app.add_subcommand("import", "Make a device.yaml of another program's calibration");
  import->require_subcommand(1);
  CLI::App* kalibr = import->add_subcommand("kalibr", "From a Kalibr camchain");
  auto arguments = std::make_shared<Arguments>();
  kalibr->add_option("camchain", arguments->camchain, "camchain.yaml")->required();
  kalibr->add_option("--nominal", arguments->nominal, "CAD mounting: JSON with `edges`, and the LiDARs");
  kalibr->add_option("-o,--out", arguments->out, "device.yaml to write")->required();
  kalibr->callback([arguments] { run_kalibr(*arguments); });
}

}  // namespace roomcal::tools
