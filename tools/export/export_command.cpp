#include "tools/export/export_command.h"

#include <memory>
#include <vector>

#include <fmt/core.h>

#include "runtime/export/export.h"
#include "runtime/export/summary.h"
#include "runtime/store/format.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/export/record_file.h"
#include "tools/export/result_json.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kTextBytes = 64 * 1024;

// The first bytes tell a record from a JSON result, whatever the file is called.
store::Record read_input(const std::string& input) {
  const std::string text = read_text(input);
  const std::string_view magic(store::kMagic.data(), store::kMagic.size());
  return std::string_view(text).starts_with(magic) ? read_record(input) : parse_result(input, text);
}

std::string text_of(const store::Record& record, exports::Format format, const std::string& camera,
                    const std::string& input) {
  std::vector<char> buffer(kTextBytes);
  TextWriter out(buffer);
  require(exports::write(record, format, camera, out), input);
  return std::string(out.view());
}

void export_ros(const store::Record& record, const std::string& input, const fs::path& folder) {
  make_folder(folder / "camera_info");
  write_atomic(folder / "rig.urdf", text_of(record, exports::Format::kUrdf, {}, input));
  write_atomic(folder / "static_transforms.launch.xml", text_of(record, exports::Format::kRosTf, {}, input));
  for (const store::SensorRecord& sensor : record.sensors) {
    if (sensor.kind != store::SensorKind::kCamera) continue;
    const std::string name(sensor.name.view());
    write_atomic(folder / "camera_info" / (name + ".yaml"), text_of(record, exports::Format::kRosInfo, name, input));
  }
}

template <typename Subject>
void print_summary(const Subject& subject) {
  std::vector<char> buffer(kTextBytes);
  TextWriter out(buffer);
  exports::write_summary(subject, out);
  fmt::print("{}", out.view());
}

}  // namespace

void export_record(const std::string& input, const std::string& format, const std::string& camera,
                   const fs::path& output) {
  const store::Record record = read_input(input);
  if (format == "ros") return export_ros(record, input, output);
  const Result<exports::Format> parsed = exports::parse_format(format);
  if (!parsed.ok())
    throw ToolError("--format " + format + ": " + parsed.status().detail() + ", ros (a folder with all of ROS)");
  write_atomic(output, text_of(record, parsed.value(), camera, input));
}

void add_export_command(CLI::App& app, int& /*exit_code*/) {
  struct Options {
    std::string input, format, camera, output;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export", "a calibration as Kalibr, ROS, Autoware, OpenCV or JSON files");
  command->add_option("input", options->input, "record file, or result of `roomcal calibrate --json`")->required();
  command
      ->add_option("--format", options->format, "json, kalibr, urdf, tf, camera_info, autoware, opencv; ros: a folder")
      ->required();
  command->add_option("--camera", options->camera, "which camera, for camera_info");
  command->add_option("-o,--output", options->output, "file to write; for ros a folder")->required();
  command->callback([options] { export_record(options->input, options->format, options->camera, options->output); });
}

void add_record_command(CLI::App& app, int& /*exit_code*/) {
  CLI::App* command = app.add_subcommand("record", "look into calibration records");
  command->require_subcommand(1);
  auto first = std::make_shared<std::string>(), second = std::make_shared<std::string>();
  CLI::App* show = command->add_subcommand("show", "what a record says");
  show->add_option("input", *first, "record file or result")->required();
  show->callback([first] { print_summary(read_input(*first)); });
  CLI::App* diff = command->add_subcommand("diff", "how far sensors moved from one record to another");
  diff->add_option("before", *first, "record file or result")->required();
  diff->add_option("after", *second, "record file or result")->required();
  diff->callback([first, second] { print_summary(store::diff(read_input(*first), read_input(*second))); });
}

}  // namespace roomcal::tools
