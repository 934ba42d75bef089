#include "runtime/marker/candidates.h"

#include <algorithm>

#include "runtime/marker/blob_shape.h"
#include "runtime/marker/components.h"
#include "runtime/marker/cut_piece.h"
#include "runtime/marker/ring_probe.h"
#include "runtime/marker/threshold.h"

namespace roomcal::marker {
namespace {

/// Candidates whose centres are this near, in minor half axes of the smaller one, are the same marker. The smaller:
/// a chance ellipse around several markers must not take the place of one of them.
constexpr double kSameMarker = 0.5;

bool same_marker(const Candidate& a, const Candidate& b) {
  const double reach_px = kSameMarker * std::min(a.outer.minor_px, b.outer.minor_px) / 2;
  return (a.outer.centre_px - b.outer.centre_px).squaredNorm() < reach_px * reach_px;
}

/// The one that reached farther out: each was seen on most rays, and the other stopped at an inner ring.
bool better(const Candidate& a, const Candidate& b) { return a.outer.major_px > b.outer.major_px; }

void add(const Candidate& candidate, CandidateList& list) {
  for (Candidate& known : list.items.first(list.count)) {
    if (!same_marker(known, candidate)) continue;
    if (better(candidate, known)) known = candidate;
    return;
  }
  if (list.count == list.items.size()) {
    ++list.dropped;
    return;
  }
  list.items[list.count++] = candidate;
}

/// Specks of light are the most common shape of noise. In a marker they sit in a dark ring, which is a blob then.
bool worth_probing(const Blob& blob) { return blob.dark_depth > 0 || half_minor(blob) >= 2; }

/// From the outermost dark blob of a nest inwards: a square sheet, turned the right way, has the supports of a circle.
bool probe_nest(ImageView image, const DetectorOptions& options, const ComponentTable& table, const Blob& top,
                CandidateList& list, Candidate& candidate) {
  const Blob* blob = &top;
  while (true) {
    if (blob->dark || blob->dark_depth == 0) {
      ++list.probed;
      if (probe_rings(image, *blob, options, candidate)) return true;
    }
    if (blob->inner < 0) return false;
    blob = &table.blobs[static_cast<std::size_t>(blob->inner)];
  }
}

void probe_blobs(ImageView image, const DetectorOptions& options, const ComponentTable& table, CandidateList& list) {
  for (const Blob& blob : table.blobs.first(table.blob_count)) {
    if (blob.has_outer || !worth_probing(blob)) continue;
    Candidate candidate;
    if (probe_nest(image, options, table, blob, list, candidate)) add(candidate, list);
  }
}

/// Markers that the border cuts: their regions are no nests, but each has an arc of an ellipse.
void probe_cut_pieces(ImageView image, const DetectorOptions& options, const ThresholdMap& map,
                      const ComponentTable& table, CandidateList& list) {
  for (const CutPiece& piece : table.pieces.first(table.piece_count)) {
    Blob blob;
    if (!fit_cut_piece(image, map, piece, blob)) continue;
    Candidate candidate;
    ++list.probed;
    if (probe_rings(image, blob, options, candidate)) add(candidate, list);
  }
}

}  // namespace

std::size_t candidate_capacity(int width_px, int height_px) {
  return std::max<std::size_t>(512, static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) / 512);
}

std::size_t candidates_bytes(int width_px, int height_px) {
  return candidate_capacity(width_px, height_px) * sizeof(Candidate) + threshold_bytes(width_px, height_px) +
         components_bytes(width_px, height_px) + 2 * alignof(std::max_align_t);
}

Status find_candidates(ImageView image, const DetectorOptions& options, Arena& arena, CandidateList& list) {
  list = {};
  list.items = arena.allocate_uninitialized<Candidate>(candidate_capacity(image.width(), image.height()));
  if (list.items.empty()) return out_of_arena("marker candidates: give the detector detector_scratch_bytes()");
  const Arena::Scope scope(arena);
  ThresholdMap thresholds;
  ROOMCAL_TRY(compute_thresholds(image, options.min_contrast, arena, thresholds));
  ComponentTable table;
  ROOMCAL_TRY(find_components(image, thresholds, arena, table));
  list.components = table.dark_components;
  list.dropped = table.dropped;
  probe_blobs(image, options, table, list);
  probe_cut_pieces(image, options, thresholds, table, list);
  return ok_status();
}

}  // namespace roomcal::marker
