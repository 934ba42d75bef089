#include "tools/sheets/sheet_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

constexpr double kEdge_mm = 5;       // what common printers cannot reach
constexpr double kSmallest_mm = 10;  // the thinnest ring of the bank is then a millimetre wide
constexpr double kNumber_mm = 8;     // from the edges of the square to the number in its corner

double largest_radius_mm(const Paper& paper) {
  return std::floor((paper.size_mm.minCoeff() / 2) / (1 + kQuietRadii + 0.03));
}

}  // namespace

const Paper& paper_named(const std::string& name) {
  static const std::array<Paper, 3> kPapers{{{"a4", {210, 297}}, {"a3", {297, 420}}, {"letter", {215.9, 279.4}}}};
  std::string wanted = name;
  std::transform(wanted.begin(), wanted.end(), wanted.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Paper& paper : kPapers) {
    if (paper.name == wanted) return paper;
  }
  throw ToolError(fmt::format("--paper {}: unknown; take a4, a3 or letter", name));
}

SheetPage layout_sheet(const Paper& paper, double radius_mm, const RingRadii& ring_radii) {
  const double largest_mm = largest_radius_mm(paper);
  if (radius_mm == 0) radius_mm = largest_mm;
  if (!(radius_mm >= kSmallest_mm && radius_mm <= largest_mm)) {
    throw ToolError(
        fmt::format("--radius {} mm: {} holds {} to {} mm with the white that a marker needs; take that or "
                    "larger paper",
                    radius_mm, paper.name, kSmallest_mm, largest_mm));
  }
  SheetPage page;
  page.paper = paper;
  page.ring_radii = ring_radii;
  page.radius_mm = radius_mm;
  page.centre_mm = Vec2::Constant(paper.size_mm.x() / 2);
  page.cut_mm = paper.size_mm.x();
  page.bar_mm = {(paper.size_mm.x() - kBar_mm) / 2, page.cut_mm + 0.35 * (paper.size_mm.y() - page.cut_mm)};
  page.note_mm = page.bar_mm + Vec2(0, 12);
  page.corner_number_mm = {std::max(kEdge_mm, kNumber_mm), page.cut_mm - kNumber_mm};
  return page;
}

}  // namespace roomcal::tools
