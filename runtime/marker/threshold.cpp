#include "runtime/marker/threshold.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace roomcal::marker {
namespace {

constexpr int kLevels = 5;

int tiles_for(int pixels, int side) { return (pixels + side - 1) / side; }

/// Darkest and lightest pixel of every tile of one level.
struct Extremes {
  Span2D<uint8_t> low;
  Span2D<uint8_t> high;
};

Status allocate_map(Arena& arena, int width, int height, Span2D<uint8_t>& map) {
  const std::span<uint8_t> bytes =
      arena.allocate_uninitialized<uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (bytes.empty()) return out_of_arena("marker thresholds: give the detector detector_scratch_bytes()");
  map = Span2D<uint8_t>(bytes.data(), width, height);
  return ok_status();
}

// The loops below are written one plain operation each over byte rows, which is what the vectorizer wants.

void fold_rows(const uint8_t* __restrict row, int width, uint8_t* __restrict low, uint8_t* __restrict high) {
  for (int x = 0; x < width; ++x) low[x] = std::min(low[x], row[x]);
  for (int x = 0; x < width; ++x) high[x] = std::max(high[x], row[x]);
}

template <typename Pick>
void halve(const uint8_t* in, int out_count, uint8_t* __restrict out, Pick pick) {
  for (int i = 0; i < out_count; ++i) out[i] = pick(in[2 * i], in[2 * i + 1]);
}

constexpr auto kMin = [](uint8_t a, uint8_t b) { return std::min(a, b); };
constexpr auto kMax = [](uint8_t a, uint8_t b) { return std::max(a, b); };

void reduce_tile_row(ImageView image, int tile_y, std::span<uint8_t> buffer, Extremes& tiles) {
  const int width = image.width();
  const std::size_t padded = static_cast<std::size_t>(tiles_for(width, kTilePx)) * kTilePx;
  uint8_t* low = buffer.data();
  uint8_t* high = low + padded;
  uint8_t* half = high + padded;
  const int y0 = tile_y * kTilePx;
  std::copy_n(image.row(y0), width, low);
  std::copy_n(image.row(y0), width, high);
  for (int y = y0 + 1; y < std::min(y0 + kTilePx, image.height()); ++y) fold_rows(image.row(y), width, low, high);
  std::fill(low + width, low + padded, low[width - 1]);
  std::fill(high + width, high + padded, high[width - 1]);
  const int count = tiles.low.width();
  halve(low, 2 * count, half, kMin);
  halve(half, count, tiles.low.row(tile_y), kMin);
  halve(high, 2 * count, half, kMax);
  halve(half, count, tiles.high.row(tile_y), kMax);
}

template <typename Pick>
void coarsen(Span2D<uint8_t> fine, Span2D<uint8_t> coarse, Pick pick) {
  for (int y = 0; y < coarse.height(); ++y) {
    const uint8_t* a = fine.row(2 * y);
    const uint8_t* b = fine.row(std::min(2 * y + 1, fine.height() - 1));
    uint8_t* out = coarse.row(y);
    const int pairs = fine.width() / 2;
    for (int x = 0; x < pairs; ++x) out[x] = pick(pick(a[2 * x], a[2 * x + 1]), pick(b[2 * x], b[2 * x + 1]));
    if (pairs < coarse.width()) out[pairs] = pick(a[2 * pairs], b[2 * pairs]);
  }
}

/// Extreme over 3 x 3 tiles around each tile of one row; `line` holds width + 2 bytes.
template <typename Pick>
void neighbourhood(Span2D<uint8_t> map, int y, uint8_t* __restrict line, uint8_t* __restrict out, Pick pick) {
  const int width = map.width();
  const uint8_t* above = map.row(std::max(y - 1, 0));
  const uint8_t* here = map.row(y);
  const uint8_t* below = map.row(std::min(y + 1, map.height() - 1));
  for (int x = 0; x < width; ++x) line[x + 1] = pick(pick(above[x], here[x]), below[x]);
  line[0] = line[1];
  line[width + 1] = line[width];
  for (int x = 0; x < width; ++x) out[x] = pick(pick(line[x], line[x + 1]), line[x + 2]);
}

struct WindowRows {
  uint8_t* line;
  uint8_t* low;
  uint8_t* high;
};

/// Contrast that a neighbourhood must show, by its lightest pixel: light surfaces are noisier than dark ones.
using GateTable = std::array<uint8_t, 256>;

constexpr std::size_t kBands = 16;
constexpr int kMaxNoiseGate = 48;  // more would hide markers, unless the whole image is that noisy

using ContrastHistogram = std::array<std::array<int, 256>, kBands>;

/// The contrast that one in `part` neighbourhoods does not reach: walls and sky, so noise.
int quiet_contrast(const std::array<int, 256>& histogram, int part) {
  int total = 0;
  for (const int count : histogram) total += count;
  if (total < 200) return 0;  // too few to tell noise from what is there
  int below = 0;
  std::size_t level = 0;
  while (level < 255 && (below += histogram[level]) * part < total) ++level;
  return static_cast<int>(level);
}

GateTable noise_gates(const Extremes& tiles, const WindowRows& rows, int min_contrast, int& quiet) {
  ContrastHistogram histogram{};
  for (int y = 0; y < tiles.low.height(); y += 2) {
    neighbourhood(tiles.low, y, rows.line, rows.low, kMin);
    neighbourhood(tiles.high, y, rows.line, rows.high, kMax);
    for (int x = 0; x < tiles.low.width(); x += 2)
      ++histogram[rows.high[x] / kBands][static_cast<std::size_t>(rows.high[x] - rows.low[x])];
  }
  std::array<int, 256> all{};
  for (const auto& band : histogram)
    for (std::size_t level = 0; level < all.size(); ++level) all[level] += band[level];
  // A wall full of small markers has few quiet places: a thirtieth is still noise and not a row of pixels from its
  // edge.
  quiet = quiet_contrast(all, 30);
  const int most = std::max(kMaxNoiseGate, quiet_contrast(all, 10) * 5 / 4);
  GateTable gates;
  for (std::size_t band = 0; band < kBands; ++band) {
    // 1.25: the widest of the quiet neighbourhoods is about that much above their lower quartile (Gaussian noise).
    const int noise = std::min(quiet_contrast(histogram[band], 4) * 5 / 4, most);
    std::fill_n(gates.begin() + static_cast<std::ptrdiff_t>(band * kBands), kBands,
                static_cast<uint8_t>(std::clamp(std::max(noise, min_contrast), 1, 255)));
  }
  return gates;
}

/// Ink in the light and paper in its shadow differ from what is beside them by a ratio. 8: black is seldom 0.
int geometric_middle(int low, int high) {
  return static_cast<int>(std::sqrt(static_cast<float>((low + 8) * (high + 8)))) - 7;
}

/// Thresholds of one level: own where the neighbourhood has contrast, else the coarser level's (0: none). A flat
/// neighbourhood is one colour: a threshold that it inherited must not cut through its noise.
void fill_level(const Extremes& tiles, const Span2D<uint8_t>* coarser, const GateTable& gates, Split split,
                const WindowRows& rows, Span2D<uint8_t> out) {
  for (int y = 0; y < out.height(); ++y) {
    neighbourhood(tiles.low, y, rows.line, rows.low, kMin);
    neighbourhood(tiles.high, y, rows.line, rows.high, kMax);
    uint8_t* thresholds = out.row(y);
    const uint8_t* fallback = coarser == nullptr ? nullptr : coarser->row(y / 2);
    for (int x = 0; x < out.width(); ++x) {
      const int low = rows.low[x];
      const int high = rows.high[x];
      const int middle = split == Split::kMiddle ? (low + high + 1) / 2 : geometric_middle(low, high);
      const int inherited = fallback == nullptr ? 0 : fallback[x / 2];
      const bool cuts = inherited > low && inherited <= high;
      const int settled = cuts ? (middle < inherited ? 255 : 0) : inherited;
      thresholds[x] = static_cast<uint8_t>(high - low >= gates[rows.high[x]] ? middle : settled);
    }
  }
}

}  // namespace

std::size_t threshold_bytes(int width_px, int height_px) {
  std::size_t bytes = 0;
  int width = tiles_for(width_px, kTilePx);
  int height = tiles_for(height_px, kTilePx);
  for (int level = 0; level < kLevels; ++level) {
    bytes += 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    width = tiles_for(width, 2);
    height = tiles_for(height, 2);
  }
  return bytes + 4 * static_cast<std::size_t>(width_px + 2 * kTilePx);
}

Status compute_thresholds(ImageView image, int min_contrast, Split split, Arena& arena, ThresholdMap& map) {
  std::array<Extremes, kLevels> tiles;
  std::array<Span2D<uint8_t>, kLevels> thresholds;
  int width = tiles_for(image.width(), kTilePx);
  int height = tiles_for(image.height(), kTilePx);
  for (std::size_t level = 0; level < kLevels; ++level) {
    ROOMCAL_TRY(allocate_map(arena, width, height, thresholds[level]));
    ROOMCAL_TRY(allocate_map(arena, width, height, tiles[level].low));
    ROOMCAL_TRY(allocate_map(arena, width, height, tiles[level].high));
    width = tiles_for(width, 2);
    height = tiles_for(height, 2);
  }
  const std::span<uint8_t> buffer =
      arena.allocate_uninitialized<uint8_t>(4 * static_cast<std::size_t>(image.width() + 2 * kTilePx));
  if (buffer.empty()) return out_of_arena("marker thresholds: give the detector detector_scratch_bytes()");
  const std::size_t row_bytes = static_cast<std::size_t>(image.width() + 2 * kTilePx);
  const WindowRows rows{buffer.data(), buffer.data() + row_bytes, buffer.data() + 2 * row_bytes};

  for (int y = 0; y < tiles[0].low.height(); ++y) reduce_tile_row(image, y, buffer, tiles[0]);
  for (std::size_t level = 1; level < kLevels; ++level) {
    coarsen(tiles[level - 1].low, tiles[level].low, kMin);
    coarsen(tiles[level - 1].high, tiles[level].high, kMax);
  }
  const GateTable gates = noise_gates(tiles[0], rows, min_contrast, map.quiet_contrast);
  for (std::size_t level = kLevels; level-- > 0;) {
    const Span2D<uint8_t>* coarser = level + 1 < kLevels ? &thresholds[level + 1] : nullptr;
    fill_level(tiles[level], coarser, gates, split, rows, thresholds[level]);
  }
  map.tiles = thresholds[0];
  return ok_status();
}

}  // namespace roomcal::marker
