#include "tools/sweep/cloud_numbers.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/core.h>

#include "tools/common/error.h"

namespace roomcal::tools {

double read_cloud_number(lidar::Bytes bytes, char type, std::endian order) {
  uint64_t word = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t shift = order == std::endian::little ? i : bytes.size() - 1 - i;
    word |= static_cast<uint64_t>(lidar::u8(bytes, i)) << (8 * shift);
  }
  if (type == 'F') {
    if (bytes.size() == 8) return std::bit_cast<double>(word);
    return bytes.size() == 4 ? static_cast<double>(std::bit_cast<float>(static_cast<uint32_t>(word)))
                             : std::numeric_limits<double>::quiet_NaN();
  }
  if (type == 'U') return static_cast<double>(word);
  switch (bytes.size()) {
    case 1:
      return static_cast<int8_t>(word);
    case 2:
      return static_cast<int16_t>(word);
    case 4:
      return static_cast<int32_t>(word);
    default:
      return static_cast<double>(static_cast<int64_t>(word));
  }
}

CloudTextReader::CloudTextReader(const std::string& name, lidar::Bytes body)
    : name_(name), text_(reinterpret_cast<const char*>(body.data()), body.size()) {}

double CloudTextReader::number() {
  constexpr std::string_view kSpace = " \t\r\n";
  at_ = text_.find_first_not_of(kSpace, at_);
  if (at_ == std::string_view::npos) {
    at_ = text_.size();
    throw ToolError(name_ + ": ends before its last point");
  }
  const std::size_t end = std::min(text_.find_first_of(kSpace, at_), text_.size());
  const std::string_view word = text_.substr(at_, end - at_);
  at_ = end;
  if (word == "nan" || word == "-nan" || word == "NaN") return std::numeric_limits<double>::quiet_NaN();
  double value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || stop != word.data() + word.size())
    throw ToolError(fmt::format("{}: byte {} of the points: expected a number", name_, end - word.size()));
  return value;
}

void CloudTextReader::skip_line() {
  const std::size_t end = text_.find('\n', at_);
  at_ = end == std::string_view::npos ? text_.size() : end + 1;
}

}  // namespace roomcal::tools
