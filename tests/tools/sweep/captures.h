#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace roomcal::tools::test {

/// Measured data: $ROOMCAL_DATA, else ../shared/data beside the sources.
inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("ROOMCAL_DATA");
  return folder != nullptr ? std::filesystem::path(folder)
                           : std::filesystem::path(ROOMCAL_SOURCE_DIR).parent_path() / "shared/data";
}

}  // namespace roomcal::tools::test

/// Sets `file` to a capture, or skips the test and says what is missing.
#define ROOMCAL_CAPTURE(file, relative)                                                  \
  const std::filesystem::path file = ::roomcal::tools::test::data_folder() / (relative); \
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no measured data at " << (file)
