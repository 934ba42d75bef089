#include "tools/sheets/ring_ratios.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "tools/common/error.h"
#include "tools/common/yaml.h"

namespace roomcal::tools {

namespace {

constexpr double kThinnest = 0.05, kSmallestDisc = 0.10, kRounding = 1e-9;

[[noreturn]] void fail(const std::string& text, const std::string& why) {
  throw ToolError(fmt::format("--ratios {}: {}; five numbers that fall, as in 85,70,55,40,25, or id0 to id{}", text,
                              why, kCctag3Percent.size() - 1));
}

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    double value = 0;
    const std::string_view word = rest.substr(0, comma);
    if (!parse_finite(word, value)) fail(text, fmt::format("`{}` is not a number", word));
    numbers.push_back(value);
    if (comma == std::string_view::npos) return numbers;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace

RingRadii parse_ratios(const std::string& text) {
  if (text.starts_with("id")) {
    double id = 0;
    const bool known =
        parse_finite(text.substr(2), id) && id >= 0 && id < kCctag3Percent.size() && id == std::floor(id);
    if (!known) fail(text, "no such CCTag-3 identity");
    return cctag3_radii(static_cast<std::size_t>(id));
  }
  const std::vector<double> numbers = numbers_in(text);
  if (numbers.size() != 5) fail(text, fmt::format("{} numbers", numbers.size()));
  const double unit = numbers.front() > 1 ? 100 : 1;
  RingRadii radii{1};
  std::transform(numbers.begin(), numbers.end(), radii.begin() + 1, [&](double value) { return value / unit; });
  for (std::size_t i = 1; i < radii.size(); ++i) {
    if (radii[i] >= radii[i - 1]) fail(text, fmt::format("{} is not below what stands before it", radii[i] * unit));
    if (radii[i - 1] - radii[i] < kThinnest - kRounding) fail(text, "a ring is thinner than 5 % of the radius");
  }
  if (radii.back() < kSmallestDisc - kRounding) fail(text, "the disc in the middle is smaller than 10 % of the radius");
  return radii;
}

}  // namespace roomcal::tools
