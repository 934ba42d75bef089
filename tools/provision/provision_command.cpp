#include "tools/provision/provision_command.h"

#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/device/device_yaml.h"
#include "tools/export/record_file.h"
#include "tools/export/result_json.h"
#include "tools/provision/factory_record.h"
#include "tools/provision/profile_file.h"
#include "tools/provision/to_profile.h"

namespace roomcal::tools {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path device;
  fs::path folder;
  fs::path factory;
};

store::Record read_factory(const fs::path& file) {
  return file.extension() == ".json" ? parse_result(file.string(), read_text(file)) : read_record(file);
}

/// Everything for the two files is made before the first of them is written.
void provision(const Arguments& arguments) {
  const auto profile = std::make_unique<profile::Profile>(to_profile(read_device(arguments.device), arguments.device));
  const auto factory = std::make_unique<store::Record>(
      arguments.factory.empty() ? factory_record(*profile)
                                : factory_record(*profile, read_factory(arguments.factory), arguments.factory));
  const AlignedBytes bytes = build_profile(*profile);
  require(check_record(*factory), arguments.factory.empty() ? arguments.device.string() : arguments.factory.string());
  make_folder(arguments.folder);
  const fs::path profile_file = arguments.folder / "device.profile", record_file = arguments.folder / "factory.record";
  write_record(record_file, *factory);
  write_atomic(profile_file, bytes.span());
  fmt::print("{}: {}, serial {}, {} cameras, {} LiDARs, {} bytes\n", profile_file.string(), profile->device.view(),
             profile->serial.empty() ? "none" : profile->serial.view(), profile->cameras.size(), profile->lidars.size(),
             bytes.span().size());
  fmt::print("{}: {} of {} sensors, {}\n", record_file.string(), factory->sensors.size(),
             profile->cameras.size() + profile->lidars.size(),
             arguments.factory.empty() ? "at their nominal mounting" : arguments.factory.string());
}

}  // namespace

void add_provision_command(CLI::App& app, int& exit_code) {
  static_cast<void>(exit_code);
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("provision", "device.yaml to the files that the device's program reads");
  command->add_option("device", arguments->device, "device.yaml")->required();
  command->add_option("-o,--output", arguments->folder, "folder to write device.profile and factory.record into")
      ->required();
  command->add_option("--factory", arguments->factory,
                      "record or result (*.json) that was measured, as the factory record instead of the drawing's");
  command->callback([arguments] { provision(*arguments); });
}

}  // namespace roomcal::tools
