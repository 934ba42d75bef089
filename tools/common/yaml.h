#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "runtime/math/types.h"

namespace roomcal::tools {

/// A finite number and nothing else; "nan", "inf", "1.0m" and "" are not. Independent of the locale.
bool parse_finite(std::string_view text, double& value);

/// A text in double quotes, so that no YAML reader takes it for something else and every one gives the same text back.
std::string yaml_quoted(std::string_view text);

/// A YAML text and the name it is known by, for messages "name:line: what is wrong".
///
/// Strict readers: whatever is missing, of another kind or not finite throws ToolError with the line and the remedy.
class YamlText {
 public:
  /// @param name  file name, for messages.
  /// @throws ToolError for what is not YAML, is larger than 64 MiB or nests deeper than any of our formats.
  YamlText(std::string name, const std::string& text);

  const YAML::Node& root() const { return root_; }
  const std::string& name() const { return name_; }

  /// @throws ToolError "name:line: message", always.
  [[noreturn]] void fail(const YAML::Node& at, const std::string& message) const;

  /// The value of a key that must be there.
  YAML::Node field(const YAML::Node& map, const std::string& key) const;
  /// Refuses keys that are not in `known`, twice the same key, and anything that is not a map.
  void allow_keys(const YAML::Node& map, std::span<const std::string_view> known, const std::string& what) const;
  void allow_keys(const YAML::Node& map, std::initializer_list<std::string_view> known, const std::string& what) const {
    allow_keys(map, std::span(known.begin(), known.size()), what);
  }

  /// `what` names the value in messages.
  double number(const YAML::Node& node, const std::string& what) const;
  int whole_number(const YAML::Node& node, const std::string& what) const;
  std::string text(const YAML::Node& node, const std::string& what) const;
  /// A sequence of exactly `count` numbers.
  std::vector<double> numbers(const YAML::Node& node, std::size_t count, const std::string& what) const;
  /// Four rows of four numbers, rotation orthonormal within 1e-4, last row 0 0 0 1.
  Mat44 transform(const YAML::Node& node, const std::string& what) const;

 private:
  std::string name_;
  YAML::Node root_;
};

}  // namespace roomcal::tools
