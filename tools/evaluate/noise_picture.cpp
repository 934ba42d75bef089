#include "tools/evaluate/noise_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "tools/evaluate/paper_figures.h"
#include "tools/evaluate/spread.h"

namespace roomcal::tools {

namespace {

constexpr double kPanelWidth = 300, kPanelHeight = 300, kPanelLeft = 62, kPanelTop = 44, kPanelGap = 84,
                 kPanelBottom = 92;
constexpr double kLow_mm = 0.01, kHigh_mm = 100, kMaxNoise_mm = 20;
constexpr const char* kOurs = "#0072b2";
constexpr const char* kPaper = "#d55e00";
constexpr const char* kBound = "#555555";

using Points = std::vector<std::pair<double, double>>;  // map noise, error, both mm

class Panel {
 public:
  Panel(int number, const std::string& title) : x0_(kPanelLeft + number * (kPanelWidth + kPanelGap)) {
    svg_ = fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='none' stroke='#888'/>\n", x0_, kPanelTop,
                       kPanelWidth, kPanelHeight);
    text(x0_ + kPanelWidth / 2, kPanelTop - 14, "middle", title);
    text(x0_ + kPanelWidth / 2, kPanelTop + kPanelHeight + 38, "middle", "map noise per axis, mm");
    for (int noise_mm = 0; noise_mm <= kMaxNoise_mm; noise_mm += 5)
      text(x(noise_mm), kPanelTop + kPanelHeight + 18, "middle", fmt::format("{}", noise_mm));
    for (const double mm : {0.01, 0.1, 1.0, 10.0, 100.0}) {
      svg_ += fmt::format("<path d='M{:.1f} {:.1f}h{}' stroke='#ccc'/>\n", x0_, y(mm), kPanelWidth);
      text(x0_ - 6, y(mm) + 4, "end", fmt::format("{}", mm));
    }
  }

  void line(const Points& points, const char* colour, const char* dashes) {
    std::string path;
    for (const auto& [noise_mm, mm] : points)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x(noise_mm), y(mm));
    svg_ += fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='2' stroke-dasharray='{}'/>\n", path, colour,
                        dashes);
  }
  void dots(const Points& points, const char* colour) {
    for (const auto& [noise_mm, mm] : points)
      svg_ += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4.5' fill='{}'/>\n", x(noise_mm), y(mm), colour);
  }
  void squares(const Points& points, const char* colour) {
    for (const auto& [noise_mm, mm] : points)
      svg_ += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='9' height='9' fill='{}'/>\n", x(noise_mm) - 4.5,
                          y(mm) - 4.5, colour);
  }
  /// From the mean to the worst shot.
  void whisker(double noise_mm, double from_mm, double to_mm) {
    svg_ += fmt::format("<path d='M{0:.1f} {1:.1f}V{2:.1f}m-4 0h8' stroke='{3}'/>\n", x(noise_mm), y(from_mm), y(to_mm),
                        kOurs);
  }
  void paper_fails() {
    svg_ += fmt::format("<path d='M{:.1f} {}v{}' stroke='{}' stroke-dasharray='2 5'/>\n", x(1e3 * kPaperNoiseLimit_m),
                        kPanelTop, kPanelHeight, kPaper);
  }
  const std::string& svg() const { return svg_; }

 private:
  double x(double noise_mm) const { return x0_ + 12 + (kPanelWidth - 24) * noise_mm / kMaxNoise_mm; }
  double y(double mm) const {
    const double share = std::log(std::clamp(mm, kLow_mm, kHigh_mm) / kLow_mm) / std::log(kHigh_mm / kLow_mm);
    return kPanelTop + kPanelHeight * (1 - share);
  }
  void text(double at_x, double at_y, const char* anchor, const std::string& words) {
    svg_ += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", at_x, at_y, anchor, words);
  }

  double x0_;
  std::string svg_;
};

template <typename Value>
Points paper_points(Value value_m) {
  Points points;
  for (const PaperNoiseRow& row : paper_noise_rows()) points.emplace_back(1e3 * row.map_sigma_m, 1e3 * value_m(row));
  return points;
}

void add_ours(const std::vector<NoiseRow>& rows, bool baseline, Panel& panel) {
  Points ours;
  for (const NoiseRow& row : rows) {
    const Spread mm = spread_of(baseline ? row.pair.baseline_m : row.pair.position_m, 1e3);
    if (row.pair.nees.empty()) continue;  // nothing was located
    ours.emplace_back(1e3 * row.map_sigma_m, mm.rms);
    panel.whisker(1e3 * row.map_sigma_m, mm.rms, mm.worst);
  }
  panel.line(ours, kOurs, "none");
  panel.dots(ours, kOurs);
}

std::string stereo_panel(const std::vector<NoiseRow>& rows) {
  Panel panel(0, "camera-camera: baseline, mm");
  Points bound;
  for (const NoiseRow& row : rows)
    if (row.bound_m > 0) bound.emplace_back(1e3 * row.map_sigma_m, 1e3 * row.bound_m);
  panel.paper_fails();
  panel.line(bound, kBound, "6 4");
  add_ours(rows, true, panel);
  panel.squares(paper_points([](const PaperNoiseRow& row) { return row.baseline_error_m; }), kPaper);
  return panel.svg();
}

std::string lidar_panel(int number, const std::string& title, const std::vector<NoiseRow>& rows, const Points& paper) {
  Panel panel(number, title);
  panel.paper_fails();
  add_ours(rows, false, panel);
  panel.squares(paper, kPaper);
  return panel.svg();
}

std::string legend() {
  const double y = kPanelTop + kPanelHeight + 66;
  return fmt::format(
      "<circle cx='70' cy='{0}' r='4.5' fill='{1}'/><text x='82' y='{2}'>ours: RMS, to the truth, all located shots; "
      "whisker to the worst</text>\n"
      "<rect x='500' y='{3}' width='9' height='9' fill='{4}'/><text x='516' y='{2}'>paper: one shot, to the drawing; "
      "fails beyond the dotted line</text>\n"
      "<path d='M945 {0}h28' stroke='{5}' stroke-width='2' stroke-dasharray='6 4'/><text x='980' y='{2}'>Cramer-Rao "
      "bound</text>\n",
      y, kOurs, y + 4, y - 4.5, kPaper, kBound);
}

}  // namespace

std::string noise_picture(const NoiseStudy& study) {
  const double width = kPanelLeft + 3 * kPanelWidth + 2 * kPanelGap + 24,
               height = kPanelTop + kPanelHeight + kPanelBottom;
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' "
             "font-family='sans-serif' font-size='13'>\n<rect width='{0}' height='{1}' fill='white'/>\n",
             width, height) +
         stereo_panel(study.stereo) +
         lidar_panel(1, "camera-LiDAR: position, mm", study.camera_lidar,
                     paper_points([](const PaperNoiseRow& row) { return row.camera_lidar.position_m; })) +
         lidar_panel(2, "LiDAR-LiDAR: position, mm", study.lidar_lidar,
                     paper_points([](const PaperNoiseRow& row) { return row.lidar_lidar_m; })) +
         legend() + "</svg>\n";
}

}  // namespace roomcal::tools
