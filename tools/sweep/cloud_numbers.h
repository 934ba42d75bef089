#pragma once

#include <bit>
#include <string>

#include "runtime/lidar/bytes.h"

namespace roomcal::tools {

inline constexpr std::size_t kMaxCloudPoints = 50'000'000;

/// A number of 1, 2, 4 or 8 bytes. @param type F, I or U
double read_cloud_number(lidar::Bytes bytes, char type, std::endian order);

/// Numbers between white space, one after another.
class CloudTextReader {
 public:
  CloudTextReader(const std::string& name, lidar::Bytes body);

  /// "nan" is a number here: clouds mark what they did not see with it. @throws ToolError at the end or for other
  /// words.
  double number();
  /// To the next line.
  void skip_line();

 private:
  const std::string& name_;
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace roomcal::tools
