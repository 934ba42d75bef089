#include "runtime/marker/reduce_marker.h"

#include <algorithm>
#include <cmath>

namespace roomcal::marker {
namespace {

constexpr double kReducedRadius_px = 60;
// Twice the reduced radius, the reach and the margin of a slanted ellipse's box, and a pixel to round: no side is
// longer.
constexpr int kMaxSide_px = 320;

struct Box {
  int x0, y0, columns, rows;  // in full pixels; in reduced ones
};

Box box_of(ImageView image, const Ellipse& outline, int factor) {
  const double half = outline.major_px / 2 + factor;
  const auto low = [half](double centre) { return std::max(0, static_cast<int>(centre - half)); };
  const auto high = [half](double centre, int size) { return std::clamp(static_cast<int>(centre + half), 0, size); };
  Box box{low(outline.centre_px.x()), low(outline.centre_px.y()), 0, 0};
  box.columns = std::min(kMaxSide_px, (high(outline.centre_px.x(), image.width()) - box.x0) / factor);
  box.rows = std::min(kMaxSide_px, (high(outline.centre_px.y(), image.height()) - box.y0) / factor);
  return box;
}

uint8_t mean_of(ImageView image, int x0, int y0, int factor) {
  int sum = 0;
  for (int y = y0; y < y0 + factor; ++y) {
    const uint8_t* row = image.row(y);
    for (int x = x0; x < x0 + factor; ++x) sum += row[x];
  }
  const int count = factor * factor;
  return static_cast<uint8_t>((sum + count / 2) / count);
}

}  // namespace

bool wants_reduction(const RingModel& model) { return model.scale_px >= 2 * kReducedRadius_px; }

std::size_t reduced_bytes() { return static_cast<std::size_t>(kMaxSide_px) * kMaxSide_px; }

Status reduce_marker(ImageView image, const RingModel& model, double reach, Arena& arena, ReducedMarker& reduced) {
  Ellipse outline;
  if (!ellipse_of_radius(model, reach, outline)) return {StatusCode::kTooFew, "marker fit: reaches the horizon"};
  reduced.factor = static_cast<int>(model.scale_px / kReducedRadius_px);
  const Box box = box_of(image, outline, reduced.factor);
  if (box.columns < 8 || box.rows < 8) return {StatusCode::kTooFew, "marker fit: outside the image"};
  const auto pixels = arena.allocate_uninitialized<uint8_t>(static_cast<std::size_t>(box.columns * box.rows));
  if (pixels.empty()) return out_of_arena("marker fit: give detect() its detector_scratch_bytes()");
  for (int y = 0; y < box.rows; ++y) {
    for (int x = 0; x < box.columns; ++x) {
      pixels[static_cast<std::size_t>(y * box.columns + x)] =
          mean_of(image, box.x0 + x * reduced.factor, box.y0 + y * reduced.factor, reduced.factor);
    }
  }
  reduced.image = ImageView(pixels.data(), box.columns, box.rows);

  // Pixel X of the reduced image lies at factor X + offset of the full one.
  const Vec2 offset_px = Vec2(box.x0, box.y0) + Vec2::Constant((reduced.factor - 1) / 2.0);
  reduced.model = model;
  reduced.model.scale_px = model.scale_px / reduced.factor;
  const Vec2 origin = (model.origin_px - offset_px) / reduced.factor;
  reduced.model.origin_px = {std::round(origin.x()), std::round(origin.y())};
  reduced.shift = (origin - reduced.model.origin_px) / reduced.model.scale_px;
  reduced.model[kCentreX] += reduced.shift.x();
  reduced.model[kCentreY] += reduced.shift.y();
  reduced.model[kLight0] -= model[kLightX] * reduced.shift.x() + model[kLightY] * reduced.shift.y();
  reduced.model[kBlur] = std::max(model[kBlur], 0.7 / reduced.model.scale_px);
  return ok_status();
}

void take_from_reduced(const ReducedMarker& reduced, RingModel& model) {
  const RingModel& fitted = reduced.model;
  const double blur = model[kBlur];
  model.value = fitted.value;
  model[kBlur] = blur;
  model[kCentreX] -= reduced.shift.x();
  model[kCentreY] -= reduced.shift.y();
  model[kLight0] += fitted[kLightX] * reduced.shift.x() + fitted[kLightY] * reduced.shift.y();
}

}  // namespace roomcal::marker
