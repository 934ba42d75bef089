#include "tools/common/yaml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include <Eigen/LU>
#include <fmt/format.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxDepth = 32;        // our formats need 6; yaml-cpp recurses per level
constexpr double kRotationTolerance = 1e-4;  // files carry rounded numbers

// An upper bound of the nesting without parsing: open brackets, levels of growing indentation, and the compact block
// openings ("- - -") of a line. Brackets inside quoted text count too; no file of ours quotes thirty of them.
class NestingBound {
 public:
  bool exceeded_by(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      if (c == '\n' || c == '\r') {
        start_line();
        continue;
      }
      const bool after_blank = i == 0 || text[i - 1] == ' ' || text[i - 1] == '\n' || text[i - 1] == '\t';
      if (c == '#' && after_blank) in_comment_ = true;
      if (in_comment_) continue;
      take(c, after_blank);
      if (flow_ > kMaxDepth || indents_.size() > kMaxDepth || openings_ > kMaxDepth) return true;
    }
    return false;
  }

 private:
  void start_line() {
    in_indent_ = true;
    in_comment_ = false;
    column_ = openings_ = 0;
  }
  void take(char c, bool after_blank) {
    if (in_indent_ && c != ' ') {
      while (!indents_.empty() && indents_.back() >= column_) indents_.pop_back();
      indents_.push_back(column_);
      in_indent_ = false;
    }
    ++column_;
    if (c == '[' || c == '{') ++flow_;
    if (c == ']' || c == '}') flow_ -= flow_ > 0 ? 1 : 0;
    if (after_blank && (c == '?' || c == ':' || c == '-')) ++openings_;
  }

  std::size_t flow_ = 0;
  std::vector<std::size_t> indents_;
  std::size_t openings_ = 0;
  std::size_t column_ = 0;
  bool in_indent_ = true;
  bool in_comment_ = false;
};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

bool parse_finite(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double parsed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(parsed)) return false;
  value = parsed;
  return true;
}

std::string yaml_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ' || byte == 0x7F) {
      result += fmt::format("\\x{:02x}", byte);
      continue;
    }
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

YamlText::YamlText(std::string name, const std::string& text) : name_(std::move(name)) {
  if (text.size() > kMaxBytes) throw ToolError(name_ + ": larger than 64 MiB; is this the right file?");
  if (text.find('\0') != std::string::npos) throw ToolError(name_ + ": not a text file; is this the right file?");
  if (NestingBound().exceeded_by(text)) throw ToolError(name_ + ": nests too deeply; is this the right file?");
  try {
    root_ = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw ToolError(fmt::format("{}:{}: not YAML: {}", name_, std::max(0, error.mark.line) + 1, one_line(error.msg)));
  }
  if (!root_.IsDefined() || root_.IsNull()) throw ToolError(name_ + ": empty; is it still being written?");
  if (!root_.IsMap()) throw ToolError(name_ + ":1: expected `key: value` lines; is this the right file?");
}

void YamlText::fail(const YAML::Node& at, const std::string& message) const {
  const int line = at.IsDefined() ? at.Mark().line : -1;
  throw ToolError(line < 0 ? fmt::format("{}: {}", name_, message)
                           : fmt::format("{}:{}: {}", name_, line + 1, message));
}

YAML::Node YamlText::field(const YAML::Node& map, const std::string& key) const {
  if (!map.IsMap()) fail(map, fmt::format("expected `key: value` lines with `{}` among them", key));
  YAML::Node value = map[key];
  if (!value.IsDefined() || value.IsNull()) fail(map, fmt::format("`{}` is missing; add it", key));
  return value;
}

void YamlText::allow_keys(const YAML::Node& map, std::span<const std::string_view> known,
                          const std::string& what) const {
  if (!map.IsMap()) fail(map, what + ": expected `key: value` lines");
  std::set<std::string> seen;
  for (const auto& entry : map) {
    const std::string key = text(entry.first, what + ": key");
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      fail(entry.first, fmt::format("{}: unknown key `{}`; known are: {}", what, key, fmt::join(known, ", ")));
    }
    if (!seen.insert(key).second) fail(entry.first, fmt::format("{}: `{}` stands twice; remove one", what, key));
  }
}

double YamlText::number(const YAML::Node& node, const std::string& what) const {
  double value = 0;
  if (!node.IsScalar() || !parse_finite(node.Scalar(), value)) {
    fail(node, fmt::format("{}: expected a finite number, got `{}`", what, node.IsScalar() ? node.Scalar() : "a list"));
  }
  return value;
}

int YamlText::whole_number(const YAML::Node& node, const std::string& what) const {
  const double value = number(node, what);
  if (value != std::floor(value) || std::abs(value) > 1e9) fail(node, what + ": expected a whole number");
  return static_cast<int>(value);
}

std::string YamlText::text(const YAML::Node& node, const std::string& what) const {
  if (!node.IsScalar() || node.Scalar().empty()) fail(node, what + ": expected a text");
  return node.Scalar();
}

std::vector<double> YamlText::numbers(const YAML::Node& node, std::size_t count, const std::string& what) const {
  if (!node.IsSequence() || node.size() != count) {
    fail(node, fmt::format("{}: expected a list of {} numbers", what, count));
  }
  std::vector<double> values;
  for (const auto& item : node) values.push_back(number(item, what));
  return values;
}

Mat44 YamlText::transform(const YAML::Node& node, const std::string& what) const {
  if (!node.IsSequence() || node.size() != 4) fail(node, what + ": expected four rows of four numbers");
  Mat44 T;
  int row = 0;
  for (const auto& item : node) T.row(row++) = Eigen::RowVector4d(numbers(item, 4, what).data());
  if ((T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 0) fail(node, what + ": the last row must be 0 0 0 1");
  const Mat33 R = T.topLeftCorner<3, 3>();
  if (R.cwiseAbs().maxCoeff() > 2 || (R * R.transpose() - Mat33::Identity()).norm() > kRotationTolerance ||
      R.determinant() < 0) {
    fail(node, what + ": the upper left 3x3 is not a rotation; give it with six digits at least");
  }
  return T;
}

}  // namespace roomcal::tools
