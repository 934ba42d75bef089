#include "tools/plan/plan_drawing.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/common/pdf.h"

namespace roomcal::tools {

namespace {

const Vec2 kPage_mm(210, 297);
constexpr double kLeft_mm = 20, kTop_mm = 32, kDrawWidth_mm = 170, kDrawHeight_mm = 238;
constexpr std::size_t kColumns = 4, kLines = 52;  // of the list of places

/// One wall on its page: metres on the wall to millimetres on paper.
class WallDrawing {
 public:
  WallDrawing(const Plan& plan, std::size_t wall, const SheetOutline& outline, Pdf& pdf)
      : plan_(plan), number_(wall), wall_(plan.walls[wall]), outline_(outline), pdf_(pdf) {
    const double scale = std::min(kDrawWidth_mm / wall_.size_m.x(), (kDrawHeight_mm - 12) / wall_.size_m.y());
    for (const double round : {1.0 / 10, 1.0 / 20, 1.0 / 25, 1.0 / 50, 1.0 / 100, 1.0 / 200, 1.0 / 500}) {
      mm_per_m_ = 1000 * round;
      if (mm_per_m_ <= scale) break;
    }
  }

  void draw() {
    pdf_.text(wall_.name, {kLeft_mm, 18}, 6);
    pdf_.text(
        fmt::format("{:.2f} x {:.2f} m, seen from inside the room, 1 : {:.0f}. Crosses are marker centres; cm from "
                    "the left and lower edge.",
                    wall_.size_m.x(), wall_.size_m.y(), 1000 / mm_per_m_),
        {kLeft_mm, 25}, 3.2);
    draw_keep_out();
    for (std::size_t i = 0; i < plan_.sheets.size(); ++i) {
      if (plan_.sheets[i].wall == number_) draw_sheet(i);
    }
    draw_frame();
  }

 private:
  Vec2 on_page(const Vec2& at_m) const {
    return {kLeft_mm + mm_per_m_ * at_m.x(), kTop_mm + mm_per_m_ * (wall_.size_m.y() - at_m.y())};
  }

  void rectangle(const Vec2& low_m, const Vec2& high_m) {
    const Vec2 a = on_page({low_m.x(), high_m.y()}), b = on_page({high_m.x(), low_m.y()});
    cairo_rectangle(pdf_.context(), a.x(), a.y(), b.x() - a.x(), b.y() - a.y());
  }

  void draw_keep_out() {
    for (const Eigen::AlignedBox2d& box : wall_.keep_out_m) {
      const Vec2 low = box.min().cwiseMax(Vec2::Zero()), high = box.max().cwiseMin(wall_.size_m);
      if ((high - low).minCoeff() <= 0) continue;
      rectangle(low, high);
      pdf_.grey(0.88);
      cairo_fill(pdf_.context());
      pdf_.grey(0.35);
      pdf_.text("keep free", on_page((low + high) / 2), 3, Pdf::Align::kMiddle);
    }
    pdf_.grey(0);
  }

  void draw_sheet(std::size_t i) {
    const Vec2& at_m = plan_.sheets[i].at_m;
    cairo_set_line_width(pdf_.context(), 0.15);
    pdf_.grey(0.6);
    rectangle(at_m + outline_.below_left_m, at_m + outline_.above_right_m);
    cairo_stroke(pdf_.context());
    pdf_.grey(0);
    const Vec2 at = on_page(at_m);
    cairo_new_sub_path(pdf_.context());
    cairo_arc(pdf_.context(), at.x(), at.y(), outline_.radius_m * mm_per_m_, 0, 2 * kPi);
    cairo_stroke(pdf_.context());
    const double type_mm = std::clamp(outline_.radius_m * mm_per_m_ * 0.75, 1.0, 3.5);
    pdf_.line(at - Vec2(0.7, 0), at + Vec2(0.7, 0));
    pdf_.line(at - Vec2(0, 0.7), at + Vec2(0, 0.7));
    pdf_.text(fmt::format("{}", i), at + Vec2(0, -0.35 * type_mm), type_mm, Pdf::Align::kMiddle);
    const Vec2 below = on_page(at_m + Vec2(0, outline_.below_left_m.y()));
    pdf_.grey(0.3);
    pdf_.text(fmt::format("{:.0f} | {:.0f}", 100 * at_m.x(), 100 * at_m.y()), below - Vec2(0, 0.5), 0.62 * type_mm,
              Pdf::Align::kMiddle);
    pdf_.grey(0);
  }

  // Outline, and a scale every half metre along the left and the lower edge.
  void draw_frame() {
    cairo_set_line_width(pdf_.context(), 0.4);
    rectangle(Vec2::Zero(), wall_.size_m);
    cairo_stroke(pdf_.context());
    cairo_set_line_width(pdf_.context(), 0.2);
    for (double m = 0; m <= wall_.size_m.x() + 1e-9; m += 0.5) {
      const Vec2 at = on_page({m, 0});
      pdf_.line(at, at + Vec2(0, 1.5));
      pdf_.text(fmt::format("{:g}", m), at + Vec2(0, 4.5), 2.6, Pdf::Align::kMiddle);
    }
    for (double m = 0; m <= wall_.size_m.y() + 1e-9; m += 0.5) {
      const Vec2 at = on_page({0, m});
      pdf_.line(at, at - Vec2(1.5, 0));
      pdf_.text(fmt::format("{:g}", m), at + Vec2(-2.2, 0.9), 2.6, Pdf::Align::kRight);
    }
  }

  const Plan& plan_;
  std::size_t number_;
  const Wall& wall_;
  const SheetOutline& outline_;
  Pdf& pdf_;
  double mm_per_m_ = 1;
};

void draw_overview(const Plan& plan, const PlanOptions& options, Pdf& pdf) {
  double y_mm = 24;
  const auto line = [&](const std::string& words, double type_mm = 3.5, double step_mm = 6.5) {
    pdf.text(words, {kLeft_mm, y_mm}, type_mm);
    y_mm += step_mm;
  };
  line("Where the sheets go", 8, 12);
  line(fmt::format("{} sheets, marker radius {:g} mm, seed {}", plan.sheets.size(), 1e3 * options.outline.radius_m,
                   options.seed));
  line(fmt::format("Expected: {:.1f} % of {} sample looks find their place, to {:.2f} mm and {:.3f} deg (median).",
                   100 * plan.coverage.located_share, plan.coverage.views.size(), 1e3 * plan.coverage.median_sigma_m,
                   rad_to_deg(plan.coverage.median_sigma_rad)),
       3.5, 12);
  for (std::size_t w = 0; w < plan.walls.size(); ++w) {
    const auto on_it = std::count_if(plan.sheets.begin(), plan.sheets.end(),
                                     [&](const PlannedSheet& sheet) { return sheet.wall == w; });
    line(fmt::format("{}: {} sheets, page {}", plan.walls[w].name, on_it, w + 2));
  }
  y_mm += 6;
  line("1  Print the sheets at 100 % on matt paper; check the 100 mm bar on one of each batch.");
  line("2  Stick them flat, over their whole back, upright or not, about where the drawings say.");
  line("3  Centimetres do not matter, the survey measures every marker; lying flat and staying put does.");
  line("4  Any sheet may go to any place; the markers are all alike. Leave out what does not fit.");
  line("5  Survey the room with the stereo pair, bake the map, look at its report.");
}

// The places once more as a list, for who measures with a tape.
void draw_list(const Plan& plan, std::size_t wall, Pdf& pdf) {
  std::vector<std::size_t> sheets;
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    if (plan.sheets[i].wall == wall) sheets.push_back(i);
  }
  std::sort(sheets.begin(), sheets.end(), [&](std::size_t a, std::size_t b) {
    return plan.sheets[a].at_m.x() != plan.sheets[b].at_m.x() ? plan.sheets[a].at_m.x() < plan.sheets[b].at_m.x()
                                                              : a < b;
  });
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    const std::size_t place = k % (kColumns * kLines), column = place / kLines, row = place % kLines;
    if (place == 0) {
      pdf.next_page(kPage_mm);
      pdf.text(plan.walls[wall].name + ": from left to right", {kLeft_mm, 18}, 6);
      for (std::size_t c = 0; c < kColumns; ++c)
        pdf.text("sheet   left   up (cm)", {kLeft_mm + 44.0 * static_cast<double>(c), 26}, 2.8);
    }
    const PlannedSheet& sheet = plan.sheets[sheets[k]];
    const Vec2 at(kLeft_mm + 44.0 * static_cast<double>(column), kTop_mm + 4.8 * static_cast<double>(row));
    pdf.text(fmt::format("{}", sheets[k]), at + Vec2(8, 0), 3.2, Pdf::Align::kRight);
    pdf.text(fmt::format("{:.0f}", 100 * sheet.at_m.x()), at + Vec2(18, 0), 3.2, Pdf::Align::kRight);
    pdf.text(fmt::format("{:.0f}", 100 * sheet.at_m.y()), at + Vec2(28, 0), 3.2, Pdf::Align::kRight);
  }
}

}  // namespace

void write_drawing(const Plan& plan, const PlanOptions& options, const std::filesystem::path& path) {
  Pdf pdf(kPage_mm, fmt::format("roomcal: where {} sheets go", plan.sheets.size()));
  draw_overview(plan, options, pdf);
  for (std::size_t w = 0; w < plan.walls.size(); ++w) {
    pdf.next_page(kPage_mm);
    WallDrawing(plan, w, options.outline, pdf).draw();
  }
  for (std::size_t w = 0; w < plan.walls.size(); ++w) draw_list(plan, w, pdf);
  pdf.save(path);
}

}  // namespace roomcal::tools
