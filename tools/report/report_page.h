#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace roomcal::tools {

/// What a report is made of; empty paths: not given.
struct ReportInput {
  std::filesystem::path result;     ///< of `roomcal calibrate --json`, or a record
  std::filesystem::path shot;       ///< the shot's folder
  std::filesystem::path map;        ///< the map that the shot was calibrated with
  std::filesystem::path installed;  ///< record or result to compare with
  std::filesystem::path truth;      ///< truth.json of a simulated shot
};

/// A page and what it had to leave out, one line each.
struct ReportPage {
  std::string html;
  std::vector<std::string> notes;
};

/// The page of `roomcal report`: one HTML file without network, below 10 MB whatever comes in.
/// @throws ToolError naming the input and the remedy: unreadable, another kind of file, another map, not this device.
ReportPage report_page(const ReportInput& input);

}  // namespace roomcal::tools
