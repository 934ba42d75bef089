#include "tools/sheets/sheet_pdf.h"

#include <fmt/format.h>

#include "tools/common/pdf.h"

namespace roomcal::tools {

namespace {

constexpr double kTick_mm = 6;  // length of a cut mark
constexpr double kBarHeight_mm = 2;
constexpr double kTwoPi = 2 * kPi;

void draw_rings(const SheetPage& page, Pdf& pdf) {
  cairo_t* context = pdf.context();
  cairo_set_fill_rule(context, CAIRO_FILL_RULE_EVEN_ODD);
  for (const double ratio : page.ring_radii) {
    cairo_new_sub_path(context);
    cairo_arc(context, page.centre_mm.x(), page.centre_mm.y(), ratio * page.radius_mm, 0, kTwoPi);
    cairo_close_path(context);
  }
  cairo_fill(context);
}

// Short, thin and grey, at the edges only: nothing near the marker that its outer circle could be mistaken for.
void draw_cut_marks(const SheetPage& page, Pdf& pdf) {
  pdf.grey(0.6);
  const double right_mm = page.paper.size_mm.x();
  pdf.line({0, page.cut_mm}, {kTick_mm, page.cut_mm});
  pdf.line({right_mm - kTick_mm, page.cut_mm}, {right_mm, page.cut_mm});
  pdf.grey(0);
}

// Solid, with its ends exactly kBar_mm apart, so that a ruler can be laid along it.
void draw_bar(const SheetPage& page, Pdf& pdf) {
  cairo_rectangle(pdf.context(), page.bar_mm.x(), page.bar_mm.y(), kBar_mm, kBarHeight_mm);
  cairo_fill(pdf.context());
  for (int i = 0; i <= 10; ++i) {
    const double x_mm = page.bar_mm.x() + i * kBar_mm / 10;
    const double inward_mm = i == 0 ? 0.125 : i == 10 ? -0.125 : 0;  // a tick's width stays within the bar
    pdf.line({x_mm + inward_mm, page.bar_mm.y()}, {x_mm + inward_mm, page.bar_mm.y() - (i % 5 == 0 ? 3 : 1.5)});
  }
}

std::string ratios_text(const RingRadii& radii) {
  std::string text;
  for (std::size_t i = 1; i < radii.size(); ++i) text += fmt::format("{}{:g}", i > 1 ? " " : "", 100 * radii[i]);
  return text;
}

void draw_sheet(const SheetPage& page, int number, Pdf& pdf) {
  draw_rings(page, pdf);
  draw_cut_marks(page, pdf);
  draw_bar(page, pdf);
  pdf.text("This bar is 100 mm long: print at 100 %, without fit to page.", page.note_mm, 4);
  pdf.text(
      fmt::format("Sheet {}   outer radius {:g} mm   rings {} %", number, page.radius_mm, ratios_text(page.ring_radii)),
      page.note_mm + Vec2(0, 7), 4);
  pdf.grey(0.45);
  pdf.text("Cut along the marks, or leave this strip on. No identity: any sheet may hang at any place.",
           page.note_mm + Vec2(0, 13), 2.8);
  pdf.text(fmt::format("{}", number), page.corner_number_mm, 3.5);
  pdf.grey(0);
}

}  // namespace

void write_sheets(const SheetPage& page, int first, int count, const std::filesystem::path& path) {
  Pdf pdf(page.paper.size_mm, fmt::format("roomcal: {} ring markers, radius {:g} mm", count, page.radius_mm));
  for (int i = 0; i < count; ++i) {
    if (i > 0) pdf.next_page(page.paper.size_mm);
    draw_sheet(page, first + i, pdf);
  }
  pdf.save(path);
}

}  // namespace roomcal::tools
