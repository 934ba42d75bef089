#include "runtime/marker/detector.h"

#include <algorithm>

#include "runtime/marker/candidates.h"
#include "runtime/marker/ellipse_of.h"
#include "runtime/marker/refine.h"

namespace roomcal::marker {
namespace {

constexpr int kMinImagePx = 16;

/// One marker seen twice, perhaps one ring off on one side: the smaller one holds the other's centre. No two sheets
/// can.
bool same_marker(const Detection& a, const Detection& b) {
  const bool a_is_smaller = a.ellipse.major_px < b.ellipse.major_px;
  return (a_is_smaller ? radius2_in(a.ellipse, b.centre_px) : radius2_in(b.ellipse, a.centre_px)) < 1;
}

/// Usable ones first, then by size (a large marker is measured better), then by place for a defined order.
bool before(const Detection& a, const Detection& b) {
  if (a.status != b.status) return a.status < b.status;
  if (a.ellipse.major_px != b.ellipse.major_px) return a.ellipse.major_px > b.ellipse.major_px;
  if (a.centre_px.y() != b.centre_px.y()) return a.centre_px.y() < b.centre_px.y();
  return a.centre_px.x() < b.centre_px.x();
}

/// Of two detections of one marker: the usable one, then the one with more rings, then the more certain one.
bool better(const Detection& a, const Detection& b) {
  if (a.status != b.status) return a.status < b.status;
  if (a.rings != b.rings) return a.rings > b.rings;
  return a.cov_px2.trace() < b.cov_px2.trace();
}

void add_once(const Detection& detection, std::span<Detection> known, std::size_t& count) {
  for (Detection& other : known.first(count)) {
    if (!same_marker(other, detection)) continue;
    if (better(detection, other)) other = detection;
    return;
  }
  known[count++] = detection;
}

/// Fits every candidate; `refined` has room for all of them.
Status refine_all(ImageView image, const DetectorOptions& options, Arena& scratch, const CandidateList& candidates,
                  std::span<Detection> refined, std::size_t& count, DetectorStats& stats) {
  for (const Candidate& candidate : candidates.items.first(candidates.count)) {
    Detection detection;
    const Status status = refine(image, candidate, options, scratch, detection);
    if (status.code() == StatusCode::kOutOfMemory) return status;
    if (status.ok())
      add_once(detection, refined, count);
    else
      ++stats.rejected;
  }
  return ok_status();
}

}  // namespace

const char* to_string(DetectionStatus status) {
  switch (status) {
    case DetectionStatus::kOk:
      return "ok";
    case DetectionStatus::kCutByBorder:
      return "cut_by_border";
    case DetectionStatus::kOccluded:
      return "occluded";
    case DetectionStatus::kUnstable:
      return "unstable";
  }
  return "unknown";
}

std::size_t detector_scratch_bytes(int width_px, int height_px) {
  return candidates_bytes(width_px, height_px) + candidate_capacity(width_px, height_px) * sizeof(Detection) +
         refine_scratch_bytes() + alignof(std::max_align_t);
}

Status detect(ImageView image, const DetectorOptions& options, Arena& scratch, std::span<Detection> out,
              std::size_t& count, DetectorStats* stats) {
  count = 0;
  DetectorStats counted;
  if (stats != nullptr) *stats = counted;
  if (image.width() < kMinImagePx || image.height() < kMinImagePx)
    return {StatusCode::kInvalidArgument, "marker detector: the image is smaller than 16 x 16 px"};
  const Arena::Scope scope(scratch);

  CandidateList candidates;
  ROOMCAL_TRY(find_candidates(image, options, scratch, candidates));
  counted.components = candidates.components;
  counted.candidates = static_cast<int>(candidates.count);

  std::span<Detection> refined;
  std::size_t found = 0;
  if (candidates.count > 0) {
    refined = scratch.allocate<Detection>(candidates.count);
    if (refined.empty()) return out_of_arena("marker detector: give it detector_scratch_bytes()");
    ROOMCAL_TRY(refine_all(image, options, scratch, candidates, refined, found, counted));
    std::sort(refined.begin(), refined.begin() + static_cast<std::ptrdiff_t>(found), before);
  }

  count = std::min(found, out.size());
  std::copy_n(refined.begin(), count, out.begin());
  counted.over_capacity = static_cast<int>(found - count) + candidates.dropped;
  if (stats != nullptr) *stats = counted;
  if (found > count) return {StatusCode::kCapacity, "marker detector: more markers than room for results"};
  if (candidates.dropped > 0)
    return {StatusCode::kCapacity, "marker detector: more ring-like shapes than its tables hold"};
  return ok_status();
}

}  // namespace roomcal::marker
