#include "runtime/marker/ring_pixels.h"

#include <algorithm>
#include <cmath>

namespace roomcal::marker {
namespace {

constexpr int kMaxStaged = 3 * kMaxRingPixels;
constexpr int kBuckets = 192;

struct StagedPixel {
  int16_t x, y;  // from the origin
  uint8_t grey;
  uint8_t bucket;
};

uint32_t hash(uint32_t a) {
  a ^= a >> 16;
  a *= 0x7feb352dU;
  a ^= a >> 15;
  a *= 0x846ca68bU;
  return a ^ (a >> 16);
}

int padded(int count) { return (count + kBlockPixels - 1) / kBlockPixels * kBlockPixels; }

Status allocate_pixels(int count, Arena& arena, RingPixels& pixels) {
  const auto size = static_cast<std::size_t>(padded(count));
  pixels.x = arena.allocate_uninitialized<float>(size);
  pixels.y = arena.allocate_uninitialized<float>(size);
  pixels.grey = arena.allocate_uninitialized<float>(size);
  pixels.count = count;
  if (pixels.grey.empty()) return out_of_arena("marker fit: give detect() its detector_scratch_bytes()");
  return ok_status();
}

// Padding repeats the last pixel, so that a block's range of radii stays narrow; its weight is zero.
void pad(RingPixels& pixels) {
  const auto count = static_cast<std::size_t>(pixels.count);
  for (std::size_t i = count; i < pixels.x.size(); ++i) {
    pixels.x[i] = pixels.x[count - 1];
    pixels.y[i] = pixels.y[count - 1];
    pixels.grey[i] = pixels.grey[count - 1];
  }
}

// What to do with a pixel at a given radius^2: buckets are equal steps of radius^2, that is of area.
struct BucketTable {
  std::array<bool, kBuckets> near_edge{};
  float per_radius2 = 0;
};

BucketTable make_table(const RingModel& model, double reach) {
  BucketTable table;
  table.per_radius2 = static_cast<float>((kBuckets - 1) / (reach * reach));
  // Two and a half sigmas of blur and a pixel of slack for the start's error, on the minor axis, where r runs fastest.
  const double minor_radius_px = model.scale_px / std::fmax(model[kShape00], model[kShape11]);
  const double margin = (2.5 * model.blur_px() + 1.0) / minor_radius_px;
  for (int i = 0; i < kBuckets; ++i) {
    const double low = std::sqrt(i / static_cast<double>(table.per_radius2));
    const double high = std::sqrt((i + 1) / static_cast<double>(table.per_radius2));
    for (int edge = 0; edge < model.edges(); ++edge) {
      const double rho = model.radius(edge);
      if (high > rho - margin && low < rho + margin) table.near_edge[static_cast<std::size_t>(i)] = true;
    }
  }
  return table;
}

struct Stage {
  std::span<StagedPixel> pixel;
  std::size_t count = 0;
};

// One row: the quadratic form is advanced along x; `stride` > 1 takes hashed steps of that mean.
void stage_row(ImageView image, const RingModel& model, const BucketTable& table, int y, int x_first, int x_last,
               int stride, Stage& stage) {
  const double scale = model.scale_px;
  const int origin_x = static_cast<int>(model.origin_px.x()), origin_y = static_cast<int>(model.origin_px.y());
  const double dy = (y - origin_y) / scale - model[kCentreY];
  const float w00 = static_cast<float>(model[kShape00] / scale), w10 = static_cast<float>(model[kShape10] / scale);
  const float u0 = static_cast<float>(-model[kShape00] * model[kCentreX]);
  const float v0 = static_cast<float>(model[kShape11] * dy - model[kShape10] * model[kCentreX]);
  const float line_step = static_cast<float>(model[kLineX] / scale);
  const float line0 = static_cast<float>(1 + model[kLineY] * dy - model[kLineX] * model[kCentreX]);
  const uint8_t* row = image.row(y);
  uint32_t state = hash(static_cast<uint32_t>(y) * 0x9e3779b9U + static_cast<uint32_t>(x_first));
  for (int x = x_first; x <= x_last && stage.count < stage.pixel.size();) {
    const float step = static_cast<float>(x - origin_x);
    const float u = u0 + w00 * step, v = v0 + w10 * step, line = line0 + line_step * step;
    const int bucket = static_cast<int>((u * u + v * v) / (line * line) * table.per_radius2);
    state = state * 1664525U + 1013904223U;
    const bool inside = bucket < kBuckets - 1;
    const bool wanted = inside && (table.near_edge[static_cast<std::size_t>(bucket)] || (state >> 30) == 0);
    stage.pixel[stage.count] = {static_cast<int16_t>(x - origin_x), static_cast<int16_t>(y - origin_y), row[x],
                                static_cast<uint8_t>(inside ? bucket : 0)};
    stage.count += wanted ? 1 : 0;
    x += stride == 1 ? 1 : 1 + static_cast<int>(hash(state) % static_cast<uint32_t>(2 * stride - 1));
  }
}

// Rows and columns of a filled ellipse.
class EllipseSpan {
 public:
  explicit EllipseSpan(const Ellipse& ellipse) : centre_(ellipse.centre_px) {
    const double cosine = std::cos(ellipse.angle_rad), sine = std::sin(ellipse.angle_rad);
    const double p = 4 / (ellipse.major_px * ellipse.major_px), q = 4 / (ellipse.minor_px * ellipse.minor_px);
    a_ = p * cosine * cosine + q * sine * sine;
    b_ = (p - q) * cosine * sine;
    c_ = p * sine * sine + q * cosine * cosine;
  }

  double half_height() const { return std::sqrt(a_ / (a_ * c_ - b_ * b_)); }

  /// @return false if the row misses the ellipse.
  bool row(double y, double& x_low, double& x_high) const {
    const double dy = y - centre_.y();
    const double discriminant = b_ * b_ * dy * dy - a_ * (c_ * dy * dy - 1);
    if (discriminant <= 0) return false;
    const double root = std::sqrt(discriminant);
    x_low = centre_.x() + (-b_ * dy - root) / a_;
    x_high = centre_.x() + (-b_ * dy + root) / a_;
    return true;
  }

 private:
  Vec2 centre_;
  double a_, b_, c_;  // a dx^2 + 2 b dx dy + c dy^2 = 1
};

Status stage_pixels(ImageView image, const RingModel& model, const BucketTable& table, double reach, Stage& stage) {
  Ellipse outline;
  if (!ellipse_of_radius(model, reach, outline)) return {StatusCode::kTooFew, "marker fit: reaches the horizon"};
  const EllipseSpan span(outline);
  const double area = kPi / 4 * outline.major_px * outline.minor_px;
  const int stride = std::max(1, static_cast<int>(std::ceil(area / kMaxStaged)));
  const int y_first = std::max(0, static_cast<int>(std::ceil(outline.centre_px.y() - span.half_height())));
  const int y_last =
      std::min(image.height() - 1, static_cast<int>(std::floor(outline.centre_px.y() + span.half_height())));
  for (int y = y_first; y <= y_last; ++y) {
    double x_low = 0, x_high = 0;
    if (!span.row(y, x_low, x_high)) continue;
    const int jitter =
        stride == 1 ? 0 : static_cast<int>(hash(static_cast<uint32_t>(y)) % static_cast<uint32_t>(stride));
    stage_row(image, model, table, y, std::max(0, static_cast<int>(std::ceil(x_low)) + jitter),
              std::min(image.width() - 1, static_cast<int>(std::floor(x_high))), stride, stage);
  }
  return ok_status();
}

// Drops pixels at random until they fit.
void thin_stage(Stage& stage) {
  if (stage.count <= kMaxRingPixels) return;
  const std::size_t total = stage.count;
  std::size_t kept = 0;
  uint32_t state = 12345;
  for (std::size_t i = 0; i < total; ++i) {
    // Selection sampling: exactly kMaxRingPixels survive (Knuth, TAOCP vol. 2, algorithm S).
    state = state * 1664525U + 1013904223U;
    const uint64_t draw = (static_cast<uint64_t>(state) * (total - i)) >> 32;
    if (draw < kMaxRingPixels - kept) stage.pixel[kept++] = stage.pixel[i];
  }
  stage.count = kept;
}

void sort_by_radius(const Stage& stage, double scale_px, RingPixels& pixels) {
  std::array<int, kBuckets + 1> start{};
  for (std::size_t i = 0; i < stage.count; ++i) ++start[stage.pixel[i].bucket + 1U];
  for (std::size_t b = 0; b < kBuckets; ++b) start[b + 1] += start[b];
  const float per_px = static_cast<float>(1.0 / scale_px);
  for (std::size_t i = 0; i < stage.count; ++i) {
    const StagedPixel& pixel = stage.pixel[i];
    const auto at = static_cast<std::size_t>(start[pixel.bucket]++);
    pixels.x[at] = static_cast<float>(pixel.x) * per_px;
    pixels.y[at] = static_cast<float>(pixel.y) * per_px;
    pixels.grey[at] = static_cast<float>(pixel.grey);
  }
}

}  // namespace

Status gather_ring_pixels(ImageView image, const RingModel& model, double reach, Arena& arena, RingPixels& pixels) {
  ROOMCAL_TRY(allocate_pixels(kMaxRingPixels, arena, pixels));
  Arena::Scope scope(arena);
  Stage stage{arena.allocate_uninitialized<StagedPixel>(kMaxStaged)};
  if (stage.pixel.empty()) return out_of_arena("marker fit: give detect() its detector_scratch_bytes()");
  ROOMCAL_TRY(stage_pixels(image, model, make_table(model, reach), reach, stage));
  thin_stage(stage);
  if (stage.count < 40) return {StatusCode::kTooFew, "marker fit: fewer than 40 pixels"};
  const auto size = static_cast<std::size_t>(padded(static_cast<int>(stage.count)));
  pixels.x = pixels.x.first(size);
  pixels.y = pixels.y.first(size);
  pixels.grey = pixels.grey.first(size);
  pixels.count = static_cast<int>(stage.count);
  sort_by_radius(stage, model.scale_px, pixels);
  pad(pixels);
  return ok_status();
}

Status thin_ring_pixels(const RingPixels& pixels, int target, Arena& arena, RingPixels& thinned) {
  ROOMCAL_TRY(allocate_pixels(std::min(pixels.count, target), arena, thinned));
  for (int i = 0; i < thinned.count; ++i) {
    const auto from = static_cast<std::size_t>(i * pixels.count / thinned.count), to = static_cast<std::size_t>(i);
    thinned.x[to] = pixels.x[from];
    thinned.y[to] = pixels.y[from];
    thinned.grey[to] = pixels.grey[from];
  }
  pad(thinned);
  return ok_status();
}

std::size_t ring_pixels_bytes() {
  return 2 * 3 * kMaxRingPixels * sizeof(float) + kMaxStaged * sizeof(StagedPixel) + 7 * 64;
}

}  // namespace roomcal::marker
