#include "runtime/marker/components.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "runtime/marker/blob_shape.h"

namespace roomcal::marker {
namespace {

constexpr int kNone = -1;
constexpr int kClosed = -2;
constexpr std::size_t kInnerSlots = 4;

/// Pixels x0..x1 of one row, all of one colour.
struct Run {
  int x0 = 0;
  int x1 = 0;
  int label = kNone;
};

/// The runs of one row; colours alternate.
struct RunRow {
  Run* runs = nullptr;
  int count = 0;
  bool first_dark = false;

  bool dark(int i) const { return first_dark != ((i & 1) != 0); }
};

/// A region that still grows, or an alias of one (alias_of >= 0) until the end of the row.
struct Region {
  Extent extent;
  int alias_of = kNone;
  int last_row = 0;
  int surround = kNone;  ///< region left of the topmost run
  uint32_t serial = 0;   ///< tells a slot used again from the region that was meant; 0: free
  uint32_t surround_serial = 0;
  int seed_x = 0;
  bool dark = false;
  int inner_count = 0;
  std::array<int, kInnerSlots> inner{};  ///< blobs that this region surrounds, largest kept
};

class Labeller {
 public:
  Labeller(ImageView image, const ThresholdMap& map, ComponentTable& table) : image_(image), map_(map), table_(table) {}

  Status allocate(Arena& arena);
  void run();

 private:
  void expand_thresholds(int tile_y);
  void extract_runs(int y);
  void link_row(int y);
  void link_run(int i, int first_above, int y);
  int open_region(int i, int y);
  int find(int region) const;
  int unite(int a, int b);
  void finish_row(int y);
  void close(Region& region);
  void close_blob(Region& region, Blob blob);
  Region* surrounding(const Region& region);
  void add_inner(Region& outer, int blob);
  void release(int slot);

  ImageView image_;
  const ThresholdMap& map_;
  ComponentTable& table_;
  std::span<uint8_t> thresholds_;
  std::span<uint8_t> mask_;
  std::span<uint8_t> change_;
  std::span<Run> run_store_;
  std::span<Region> regions_;
  std::span<int> free_;
  std::span<int> merged_;
  int free_count_ = 0;
  int merged_count_ = 0;
  RunRow above_;
  RunRow here_;
  uint32_t next_serial_ = 1;
};

std::size_t padded(int width) { return (static_cast<std::size_t>(width) + 7) / 8 * 8 + 8; }

// A row has at most `width` runs; regions alive or aliased stem from the runs of two rows.
std::size_t region_capacity(int width) { return 2 * static_cast<std::size_t>(width) + 2; }

std::size_t blob_capacity(int width, int height) {
  return std::max<std::size_t>(2048, static_cast<std::size_t>(width) * static_cast<std::size_t>(height) / 128);
}

std::size_t piece_capacity(int width, int height) { return static_cast<std::size_t>(width + height) / 8 + 32; }

Status Labeller::allocate(Arena& arena) {
  const int width = image_.width();
  thresholds_ = arena.allocate<uint8_t>(padded(width));
  mask_ = arena.allocate<uint8_t>(padded(width));
  change_ = arena.allocate<uint8_t>(padded(width));
  run_store_ = arena.allocate_uninitialized<Run>(2 * static_cast<std::size_t>(width));
  regions_ = arena.allocate<Region>(region_capacity(width));
  free_ = arena.allocate_uninitialized<int>(region_capacity(width));
  merged_ = arena.allocate_uninitialized<int>(region_capacity(width));
  table_.blobs = arena.allocate_uninitialized<Blob>(blob_capacity(width, image_.height()));
  table_.pieces = arena.allocate_uninitialized<CutPiece>(piece_capacity(width, image_.height()));
  if (thresholds_.empty() || mask_.empty() || change_.empty() || run_store_.empty() || regions_.empty() ||
      free_.empty() || merged_.empty() || table_.blobs.empty() || table_.pieces.empty())
    return out_of_arena("marker components: give the detector detector_scratch_bytes()");
  free_count_ = static_cast<int>(free_.size());
  for (int i = 0; i < free_count_; ++i) free_[static_cast<std::size_t>(i)] = free_count_ - 1 - i;
  above_.runs = run_store_.data();
  here_.runs = above_.runs + width;
  return ok_status();
}

void Labeller::run() {
  for (int y = 0; y < image_.height(); ++y) {
    if (y % kTilePx == 0) expand_thresholds(y / kTilePx);
    extract_runs(y);
    link_row(y);
    finish_row(y);
    std::swap(above_, here_);
  }
  here_.count = 0;
  finish_row(image_.height());
}

void Labeller::expand_thresholds(int tile_y) {
  static_assert(kTilePx == 4);
  const uint8_t* tiles = map_.tiles.row(tile_y);
  for (int t = 0; t < map_.tiles.width(); ++t) {
    const uint32_t four = tiles[t] * 0x01010101U;
    std::memcpy(thresholds_.data() + 4 * t, &four, sizeof four);
  }
}

/// Eight pixels at a time where nothing changes, which is most of most images.
void Labeller::extract_runs(int y) {
  const int width = image_.width();
  const uint8_t* __restrict pixel = image_.row(y);
  const uint8_t* __restrict threshold = thresholds_.data();
  uint8_t* __restrict mask = mask_.data();
  uint8_t* __restrict change = change_.data();
  for (int x = 0; x < width; ++x) mask[x] = pixel[x] < threshold[x] ? 1 : 0;
  change[0] = 0;
  for (int x = 1; x < width; ++x) change[x] = mask[x] ^ mask[x - 1];
  here_.first_dark = mask[0] != 0;
  Run* run = here_.runs;
  run->x0 = 0;
  for (int x = 0; x < width; x += 8) {
    uint64_t eight = 0;
    std::memcpy(&eight, change + x, sizeof eight);
    for (; eight != 0; eight &= eight - 1) {
      const int bit = std::countr_zero(eight);
      const int at = x + (std::endian::native == std::endian::little ? bit / 8 : 7 - bit / 8);
      run->x1 = at - 1;
      ++run;
      run->x0 = at;
    }
  }
  run->x1 = width - 1;
  here_.count = static_cast<int>(run - here_.runs) + 1;
}

void Labeller::link_row(int y) {
  int first_above = 0;
  for (int i = 0; i < here_.count; ++i) {
    while (first_above < above_.count && above_.runs[first_above].x1 < here_.runs[i].x0 - 1) ++first_above;
    link_run(i, first_above, y);
  }
}

void Labeller::link_run(int i, int first_above, int y) {
  Run& run = here_.runs[i];
  const bool dark = here_.dark(i);
  const int reach = dark ? 1 : 0;
  run.label = kNone;
  int j = first_above;
  if (j < above_.count && above_.dark(j) != dark) ++j;
  for (; j < above_.count && above_.runs[j].x0 <= run.x1 + reach; j += 2) {
    if (above_.runs[j].x1 < run.x0 - reach) continue;
    const int root = find(above_.runs[j].label);
    run.label = run.label == kNone || run.label == root ? root : unite(run.label, root);
  }
  if (run.label == kNone) run.label = open_region(i, y);
  Region& region = regions_[static_cast<std::size_t>(run.label)];
  Extent& e = region.extent;
  e.x_min = std::min(e.x_min, run.x0);
  e.x_max = std::max(e.x_max, run.x1);
  e.sum_min = std::min(e.sum_min, run.x0 + y);
  e.sum_max = std::max(e.sum_max, run.x1 + y);
  e.diff_min = std::min(e.diff_min, run.x0 - y);
  e.diff_max = std::max(e.diff_max, run.x1 - y);
  e.y_max = y;
  e.area += run.x1 - run.x0 + 1;
  region.last_row = y;
}

int Labeller::open_region(int i, int y) {
  const Run& run = here_.runs[i];
  const int slot = free_[static_cast<std::size_t>(--free_count_)];
  Region& region = regions_[static_cast<std::size_t>(slot)];
  region.extent = {run.x0, run.x1, y, y, run.x0 + y, run.x1 + y, run.x0 - y, run.x1 - y, 0};
  region.alias_of = kNone;
  region.last_row = y;
  region.serial = next_serial_++;
  region.surround = i > 0 ? here_.runs[i - 1].label : kNone;
  region.surround_serial = i > 0 ? regions_[static_cast<std::size_t>(region.surround)].serial : 0;
  region.seed_x = run.x0;
  region.dark = here_.dark(i);
  region.inner_count = 0;
  return slot;
}

int Labeller::find(int region) const {
  while (regions_[static_cast<std::size_t>(region)].alias_of >= 0)
    region = regions_[static_cast<std::size_t>(region)].alias_of;
  return region;
}

/// The older one lives on: its topmost run is the higher, and that run knows what surrounds them.
int Labeller::unite(int a, int b) {
  a = find(a);
  b = find(b);
  if (a == b) return a;
  Region* keep = &regions_[static_cast<std::size_t>(a)];
  Region* drop = &regions_[static_cast<std::size_t>(b)];
  if (drop->serial < keep->serial) {
    std::swap(keep, drop);
    std::swap(a, b);
  }
  Extent& e = keep->extent;
  const Extent& f = drop->extent;
  e.x_min = std::min(e.x_min, f.x_min);
  e.x_max = std::max(e.x_max, f.x_max);
  e.y_min = std::min(e.y_min, f.y_min);
  e.y_max = std::max(e.y_max, f.y_max);
  e.sum_min = std::min(e.sum_min, f.sum_min);
  e.sum_max = std::max(e.sum_max, f.sum_max);
  e.diff_min = std::min(e.diff_min, f.diff_min);
  e.diff_max = std::max(e.diff_max, f.diff_max);
  e.area += f.area;
  keep->last_row = std::max(keep->last_row, drop->last_row);
  for (int i = 0; i < drop->inner_count; ++i) add_inner(*keep, drop->inner[static_cast<std::size_t>(i)]);
  drop->alias_of = a;
  merged_[static_cast<std::size_t>(merged_count_++)] = b;
  return a;
}

/// Resolves aliases, judges the regions that end above this row, and gives slots back.
void Labeller::finish_row(int y) {
  if (merged_count_ > 0) {
    for (int i = 0; i < here_.count; ++i) {
      Run& run = here_.runs[i];
      run.label = find(run.label);
      Region& region = regions_[static_cast<std::size_t>(run.label)];
      if (region.surround == kNone || regions_[static_cast<std::size_t>(region.surround)].alias_of < 0) continue;
      Region* outer = surrounding(region);
      region.surround = outer == nullptr ? kNone : static_cast<int>(outer - regions_.data());
      region.surround_serial = outer == nullptr ? 0 : outer->serial;
    }
  }
  for (int j = 0; j < above_.count; ++j) {
    Region& region = regions_[static_cast<std::size_t>(above_.runs[j].label)];
    if (region.alias_of >= 0 || region.last_row == y || region.last_row == kClosed) continue;
    close(region);
    region.last_row = kClosed;
    merged_[static_cast<std::size_t>(merged_count_++)] = above_.runs[j].label;
  }
  for (int i = 0; i < merged_count_; ++i) release(merged_[static_cast<std::size_t>(i)]);
  merged_count_ = 0;
}

void Labeller::release(int slot) {
  Region& region = regions_[static_cast<std::size_t>(slot)];
  region.serial = 0;
  region.alias_of = kNone;
  free_[static_cast<std::size_t>(free_count_++)] = slot;
}

Region* Labeller::surrounding(const Region& region) {
  if (region.surround == kNone) return nullptr;
  if (regions_[static_cast<std::size_t>(region.surround)].serial != region.surround_serial) return nullptr;
  return &regions_[static_cast<std::size_t>(find(region.surround))];
}

void Labeller::close(Region& region) {
  if (region.dark) ++table_.dark_components;
  const Extent& e = region.extent;
  if (e.width() < kMinBlobPx || e.height() < kMinBlobPx) return;
  const bool cut = e.x_min == 0 || e.y_min == 0 || e.x_max == image_.width() - 1 || e.y_max == image_.height() - 1;
  if (!cut) {
    Blob blob;
    if (fit_blob(e, blob)) close_blob(region, blob);
    return;
  }
  if (std::max(e.width(), e.height()) < kMinCutPiecePx) return;
  if (table_.piece_count == table_.pieces.size()) {
    ++table_.dropped;
    return;
  }
  table_.pieces[table_.piece_count++] = {e, region.dark, region.seed_x, e.y_min};
}

void Labeller::close_blob(Region& region, Blob blob) {
  blob.dark = region.dark;
  blob.dark_depth = region.dark ? 1 : 0;
  double largest = 0;
  for (int i = 0; i < region.inner_count; ++i) {
    const int index = region.inner[static_cast<std::size_t>(i)];
    const Blob& inner = table_.blobs[static_cast<std::size_t>(index)];
    if (!concentric(blob, inner) || inner.sxx + inner.syy <= largest) continue;
    largest = inner.sxx + inner.syy;
    blob.inner = index;
  }
  if (blob.inner < 0 && !worth_keeping_alone(blob, region.extent.area)) return;
  if (table_.blob_count == table_.blobs.size()) {
    ++table_.dropped;
    return;
  }
  if (blob.inner >= 0) {
    Blob& inner = table_.blobs[static_cast<std::size_t>(blob.inner)];
    inner.has_outer = true;
    blob.depth = inner.depth + 1;
    blob.dark_depth += inner.dark_depth;
  }
  const int index = static_cast<int>(table_.blob_count);
  table_.blobs[table_.blob_count++] = blob;
  if (Region* outer = surrounding(region); outer != nullptr && outer->dark != region.dark) add_inner(*outer, index);
}

/// Keeps the largest few: the concentric one is among them, the crescents of a merged ring are smaller.
void Labeller::add_inner(Region& outer, int blob) {
  const auto size = [this](int index) {
    const Blob& b = table_.blobs[static_cast<std::size_t>(index)];
    return b.sxx + b.syy;
  };
  if (outer.inner_count < static_cast<int>(kInnerSlots)) {
    outer.inner[static_cast<std::size_t>(outer.inner_count++)] = blob;
    return;
  }
  int& smallest =
      *std::min_element(outer.inner.begin(), outer.inner.end(), [&size](int a, int b) { return size(a) < size(b); });
  if (size(blob) > size(smallest)) smallest = blob;
}

}  // namespace

std::size_t components_bytes(int width_px, int height_px) {
  const std::size_t width = static_cast<std::size_t>(width_px);
  return 3 * padded(width_px) + 2 * width * sizeof(Run) +
         region_capacity(width_px) * (sizeof(Region) + 2 * sizeof(int)) +
         blob_capacity(width_px, height_px) * sizeof(Blob) + piece_capacity(width_px, height_px) * sizeof(CutPiece) +
         9 * alignof(std::max_align_t);
}

Status find_components(ImageView image, const ThresholdMap& map, Arena& arena, ComponentTable& table) {
  table = {};
  Labeller labeller(image, map, table);
  ROOMCAL_TRY(labeller.allocate(arena));
  labeller.run();
  return ok_status();
}

}  // namespace roomcal::marker
