#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "tools/common/error.h"
#include "tools/common/yaml.h"
#include "tools/map/import_checks.h"
#include "tools/map/map_import.h"

namespace roomcal::tools {

namespace {

constexpr std::array<std::string_view, 8> kColumns{"id", "x", "y", "z", "nx", "ny", "nz", "radius"};
enum Column { kId, kX, kY, kZ, kNx, kNy, kNz, kRadius, kColumnCount };
constexpr double kUnitSlack = 0.01;  // of a normal's length; more is not rounding but another quantity

/// Where each column stands in a line; -1: not there.
using Layout = std::array<int, kColumnCount>;
using Cells = std::vector<std::string_view>;

std::string_view trim(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

Cells split(std::string_view line) {
  Cells cells;
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

class CsvReader {
 public:
  explicit CsvReader(const std::string& name) : name_(name) {}

  void take_line(std::string_view line) {
    ++line_;
    if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);  // a spreadsheet's byte-order mark
    line = trim(line);
    if (line.empty() || line.front() == '#') return;
    const Cells cells = split(line);
    if (layout_) return take_marker(cells);
    const bool is_header = std::isalpha(static_cast<unsigned char>(line.front())) != 0;
    layout_ = is_header ? named_layout(cells) : counted_layout(cells.size());
    columns_ = cells.size();
    if (!is_header) take_marker(cells);
  }

  MapData finish() {
    if (data_.markers.empty()) throw ToolError(name_ + ": no marker in it; expected lines of id,x,y,z,nx,ny,nz,radius");
    return std::move(data_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw ToolError(fmt::format("{}:{}: {}", name_, line_, message));
  }
  void check(const std::string& wrong) const {
    if (!wrong.empty()) fail(wrong);
  }

  Layout named_layout(const Cells& cells) const {
    Layout layout;
    layout.fill(-1);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto known = std::find(kColumns.begin(), kColumns.end(), cells[i]);
      if (known == kColumns.end()) {
        fail(fmt::format("unknown column `{}`; known are {}", cells[i], fmt::join(kColumns, ",")));
      }
      int& place = layout[static_cast<std::size_t>(known - kColumns.begin())];
      if (place >= 0) fail(fmt::format("column `{}` stands twice", cells[i]));
      place = static_cast<int>(i);
    }
    for (const Column needed : {kId, kX, kY, kZ}) {
      if (layout[needed] < 0) fail(fmt::format("column `{}` is missing; expected id,x,y,z at least", kColumns[needed]));
    }
    const int normals = (layout[kNx] >= 0) + (layout[kNy] >= 0) + (layout[kNz] >= 0);
    if (normals != 0 && normals != 3) fail("of nx,ny,nz some are missing; give all three or none");
    return layout;
  }

  Layout counted_layout(std::size_t count) const {
    switch (count) {
      case 4:
        return {0, 1, 2, 3, -1, -1, -1, -1};
      case 5:
        return {0, 1, 2, 3, -1, -1, -1, 4};
      case 7:
        return {0, 1, 2, 3, 4, 5, 6, -1};
      case 8:
        return {0, 1, 2, 3, 4, 5, 6, 7};
      default:
        break;
    }
    fail(fmt::format("{} columns and no header; expected id,x,y,z then nx,ny,nz and radius where known", count));
  }

  std::string_view cell(const Cells& cells, Column column) const {
    return (*layout_)[column] < 0 ? std::string_view{} : cells[static_cast<std::size_t>((*layout_)[column])];
  }

  double number(const Cells& cells, Column column) const {
    const std::string_view text = cell(cells, column);
    double value = 0;
    if (!parse_finite(text, value)) fail(fmt::format("{}: `{}` is not a finite number", kColumns[column], text));
    return value;
  }

  void take_marker(const Cells& cells) {
    if (cells.size() != columns_) {
      fail(fmt::format("{} columns, the lines before have {}; is a comma missing?", cells.size(), columns_));
    }
    map::MapMarker marker;
    check(ids_.take(cell(cells, kId), line_, marker.id));
    marker.p_room = {number(cells, kX), number(cells, kY), number(cells, kZ)};
    check(wrong_with_position(marker.p_room));
    take_normal(cells, marker);
    if (!cell(cells, kRadius).empty()) {
      marker.radius_m = number(cells, kRadius);
      check(wrong_with_radius(marker.radius_m));
      marker.has_radius = true;
    }
    data_.markers.push_back(marker);
  }

  void take_normal(const Cells& cells, map::MapMarker& marker) const {
    if (cell(cells, kNx).empty() && cell(cells, kNy).empty() && cell(cells, kNz).empty()) return;
    const Vec3 normal(number(cells, kNx), number(cells, kNy), number(cells, kNz));
    if (!(std::abs(normal.norm() - 1) < kUnitSlack)) {
      fail(fmt::format("nx,ny,nz: length {:.4g} instead of 1; give a unit vector into the room", normal.norm()));
    }
    marker.normal_room = normal.normalized();
    marker.has_normal = true;
  }

  const std::string& name_;
  std::size_t line_ = 0;
  std::optional<Layout> layout_;
  std::size_t columns_ = 0;
  SeenIds ids_;
  MapData data_;
};

}  // namespace

MapData parse_map_csv(const std::string& name, const std::string& text) {
  CsvReader reader(name);
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    reader.take_line(std::string_view(text).substr(start, end - start));
    start = end + 1;
  }
  return reader.finish();
}

}  // namespace roomcal::tools
