#include "runtime/marker/candidates.h"

#include <algorithm>
#include <cmath>

#include "runtime/marker/blob_shape.h"
#include "runtime/marker/components.h"
#include "runtime/marker/cut_piece.h"
#include "runtime/marker/halve_image.h"
#include "runtime/marker/ring_probe.h"
#include "runtime/marker/small_markers.h"
#include "runtime/marker/threshold.h"

namespace roomcal::marker {
namespace {

/// Smaller images have no marker that the halved pass could find and the first one could not.
constexpr int kHalvedPassPx = 64;

/// Candidates whose centres are this near, in minor half axes of the smaller one, may be the same marker.
constexpr double kSameCentre = 0.5;
/// And whose sizes are within this part. Of two that differ one stopped at an inner ring or went beyond the marker: the
/// fit tells which, and detect() keeps one.
constexpr double kSameSize = 0.1;

bool same_ellipse(const Candidate& a, const Candidate& b) {
  const double reach_px = kSameCentre * std::min(a.outer.minor_px, b.outer.minor_px) / 2;
  return (a.outer.centre_px - b.outer.centre_px).squaredNorm() < reach_px * reach_px &&
         std::abs(a.outer.major_px - b.outer.major_px) < kSameSize * std::max(a.outer.major_px, b.outer.major_px);
}

/// What one pass looks at, and where its pixels lie in the full image: p_full = scale * p + offset.
struct Pass {
  ImageView image;
  Split split = Split::kMiddle;
  double scale = 1;
  double offset_px = 0;
};

Blob in_full_image(Blob blob, const Pass& pass) {
  blob.x = pass.scale * blob.x + pass.offset_px;
  blob.y = pass.scale * blob.y + pass.offset_px;
  blob.sxx *= pass.scale * pass.scale;
  blob.sxy *= pass.scale * pass.scale;
  blob.syy *= pass.scale * pass.scale;
  return blob;
}

/// Does a candidate already stand around this blob's centre, at least as large as the blob?
bool is_known(const Blob& blob, const CandidateList& list) {
  const Vec2 centre_px(blob.x, blob.y);
  for (const Candidate& known : list.items.first(list.count)) {
    const double reach_px = kSameCentre * known.outer.minor_px / 2;
    if ((known.outer.centre_px - centre_px).squaredNorm() > reach_px * reach_px) continue;
    if (known.rings >= 3 && half_major(blob) < 0.55 * known.outer.major_px) return true;
  }
  return false;
}

void probe(ImageView full, const DetectorOptions& options, const Blob& blob, CandidateList& list, bool& found) {
  Candidate candidate;
  ++list.probed;
  found = probe_rings(full, blob, options, candidate);
  if (found) add_candidate(candidate, list);
}

/// Specks of light are the most common shape of noise. In a marker they sit in a dark ring, which is a blob then.
bool worth_probing(const Blob& blob) { return blob.dark_depth > 0 || half_minor(blob) >= 2.5; }

/// From the outermost dark blob of a nest inwards: a square sheet, turned the right way, has the supports of a circle.
void probe_nest(ImageView full, const DetectorOptions& options, const Pass& pass, const ComponentTable& table,
                const Blob& top, CandidateList& list) {
  const Blob* blob = &top;
  while (true) {
    const Blob in_full = in_full_image(*blob, pass);
    if (blob->dark || blob->dark_depth == 0) {
      if (is_known(in_full, list)) return;
      bool found = false;
      probe(full, options, in_full, list, found);
      if (found) return;
    }
    if (blob->inner < 0) return;
    blob = &table.blobs[static_cast<std::size_t>(blob->inner)];
  }
}

/// Markers that the border cuts: their regions are no nests, but each has an arc of an ellipse.
void probe_cut_pieces(ImageView full, const DetectorOptions& options, const Pass& pass, const ThresholdMap& map,
                      const ComponentTable& table, CandidateList& list) {
  for (const CutPiece& piece : table.pieces.first(table.piece_count)) {
    Blob blob;
    if (!fit_cut_piece(pass.image, map, piece, blob)) continue;
    blob = in_full_image(blob, pass);
    bool found = false;
    if (!is_known(blob, list)) probe(full, options, blob, list, found);
  }
}

Status run_pass(ImageView full, const DetectorOptions& options, const Pass& pass, Arena& arena, CandidateList& list,
                int& quiet_contrast) {
  const Arena::Scope scope(arena);
  ThresholdMap thresholds;
  ROOMCAL_TRY(compute_thresholds(pass.image, options.min_contrast, pass.split, arena, thresholds));
  quiet_contrast = thresholds.quiet_contrast;
  ComponentTable table;
  ROOMCAL_TRY(find_components(pass.image, thresholds, arena, table));
  list.components += table.dark_components;
  list.dropped += table.dropped;
  for (const Blob& blob : table.blobs.first(table.blob_count))
    if (!blob.has_outer && worth_probing(blob)) probe_nest(full, options, pass, table, blob, list);
  probe_cut_pieces(full, options, pass, thresholds, table, list);
  return ok_status();
}

}  // namespace

void add_candidate(const Candidate& candidate, CandidateList& list) {
  for (Candidate& known : list.items.first(list.count)) {
    if (!same_ellipse(known, candidate)) continue;
    if (candidate.rings > known.rings) known = candidate;
    return;
  }
  if (list.count == list.items.size()) {
    ++list.dropped;
    return;
  }
  list.items[list.count++] = candidate;
}

std::size_t candidate_capacity(int width_px, int height_px) {
  return std::max<std::size_t>(512, static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) / 512);
}

std::size_t candidates_bytes(int width_px, int height_px) {
  const auto pass_bytes = [](int width, int height) {
    return threshold_bytes(width, height) + components_bytes(width, height);
  };
  const std::size_t halved = halved_bytes(width_px, height_px) + pass_bytes(width_px / 2, height_px / 2);
  return candidate_capacity(width_px, height_px) * sizeof(Candidate) + small_markers_bytes(width_px) +
         3 * alignof(std::max_align_t) + std::max(pass_bytes(width_px, height_px), halved);
}

Status find_candidates(ImageView image, const DetectorOptions& options, Arena& arena, CandidateList& list) {
  list = {};
  list.items = arena.allocate_uninitialized<Candidate>(candidate_capacity(image.width(), image.height()));
  if (list.items.empty()) return out_of_arena("marker candidates: give the detector detector_scratch_bytes()");
  const Arena::Scope scope(arena);
  int quiet_contrast = 0;
  ROOMCAL_TRY(run_pass(image, options, {image, Split::kMiddle, 1.0, 0.0}, arena, list, quiet_contrast));
  if (image.width() >= kHalvedPassPx && image.height() >= kHalvedPassPx) {
    MutableImageView half;
    int quiet_of_half = 0;
    ROOMCAL_TRY(halve_image(image, arena, half));
    ROOMCAL_TRY(run_pass(image, options, {half, Split::kGeometric, 2.0, 0.5}, arena, list, quiet_of_half));
  }
  // Half of what noise spans over 12 x 12 px is about two and a half sigma, above eight neighbours at that.
  return find_small_markers(image, options, std::max(options.min_contrast, quiet_contrast) / 2, arena, list);
}

}  // namespace roomcal::marker
