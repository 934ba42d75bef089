#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/span2d.h"
#include "runtime/base/status.h"
#include "runtime/math/types.h"

namespace roomcal::marker {

/// What became of a ring marker that was seen. Only kOk may be used for localization.
enum class DetectionStatus : uint8_t {
  kOk,
  kCutByBorder,  ///< the outer circle leaves the image
  kOccluded,     ///< part of the outer circle is hidden
  kUnstable,     ///< the fit did not meet its residual or covariance limit
};

/// Printable name, as in the JSON of `roomcal detect`: "ok", "cut_by_border", ...
const char* to_string(DetectionStatus status);

/// The outer circle's image: full axes (diameters), angle from +x to the major axis towards +y.
struct Ellipse {
  Vec2 centre_px = Vec2::Zero();
  double major_px = 0;
  double minor_px = 0;
  double angle_rad = 0;
};

/// One ring marker. `centre_px` is the projection of the 3-D circle centre, not the centre of the ellipse.
struct Detection {
  Vec2 centre_px = Vec2::Zero();
  Mat22 cov_px2 = Mat22::Zero();
  Ellipse ellipse;
  int rings = 0;
  DetectionStatus status = DetectionStatus::kUnstable;
};

/// Effects and ranges; the defaults suit every camera that we know.
struct DetectorOptions {
  int min_contrast = 16;  ///< grey levels between ink and paper, at the least; lower finds dimmer markers, costs time
  double min_diameter_px = 12;  ///< major axis of the outer circle
  int min_rings = 3;            ///< fewer are something else
  int max_rings = 5;
};

/// Counters of the last call; telemetry, not results.
struct DetectorStats {
  int components = 0;     ///< dark components looked at
  int candidates = 0;     ///< concentric groups sent to the fit
  int rejected = 0;       ///< candidates that the fit or its checks refused
  int over_capacity = 0;  ///< markers found when `out` was full: never silent, the status says kCapacity too
};

/// Scratch that detect() needs for an image of this size, bytes.
std::size_t detector_scratch_bytes(int width_px, int height_px);

/// Finds ring markers (three or more dark concentric rings on a light sheet), identity ignored.
///
/// @param image    8-bit luminance, from 16 x 16 px.
/// @param scratch  at least detector_scratch_bytes() free; used within a scope, given back on return.
/// @param out      room for the results; @param[out] count how many were written, status kOk first.
/// @return kOk (zero markers is a value); kInvalidArgument for an image too small; kOutOfMemory, nothing written;
///         kCapacity when there were more than out.size(): the first out.size() are valid, stats tells how many not.
/// Cost: about 2 ms per megapixel and 0.2 ms per marker; no allocation, no recursion, deterministic.
Status detect(ImageView image, const DetectorOptions& options, Arena& scratch, std::span<Detection> out,
              std::size_t& count, DetectorStats* stats = nullptr);

}  // namespace roomcal::marker
