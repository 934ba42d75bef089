#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal export RECORD|RESULT.json --format F -o OUT`: the files that other software reads.
void add_export_command(CLI::App& app, int& exit_code);

/// `roomcal record show FILE`, `roomcal record diff A B`: what is in a record, and how two of them differ.
void add_record_command(CLI::App& app, int& exit_code);

/// Writes one export, or with format "ros" a folder of rig.urdf, static_transforms.launch.xml and
/// camera_info/<name>.yaml.
/// @param camera  for format "camera_info".
/// @throws ToolError naming the file and the remedy.
void export_record(const std::string& input, const std::string& format, const std::string& camera,
                   const std::filesystem::path& output);

}  // namespace roomcal::tools
