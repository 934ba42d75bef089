#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "runtime/lidar/calibration.h"
#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

inline constexpr double kTwoPi = 2 * kPi;
inline constexpr int kTurnCdeg = 36000;
constexpr double cdeg_to_rad(double cdeg) { return cdeg * (kPi / 18000); }

/// An angle with its sine and cosine.
struct Direction {
  double angle_rad = 0, sin = 0, cos = 1;

  static Direction of(double angle_rad) { return {angle_rad, std::sin(angle_rad), std::cos(angle_rad)}; }
  /// Turned on by a small angle, at most 0.05 rad (three degrees): the series' error is below 1e-10.
  Direction turned_slightly(double d) const {
    const double d2 = d * d;
    const double s = d * (1 - d2 / 6), c = 1 - d2 / 2 + d2 * d2 / 24;
    return {angle_rad + d, sin * c + cos * s, cos * c - sin * s};
  }
  /// Turned on by an angle whose sine and cosine are known.
  Direction turned(double d, double sin_d, double cos_d) const {
    return {angle_rad + d, sin * cos_d + cos * sin_d, cos * cos_d - sin * sin_d};
  }
};

/// In [0, 2 pi) for an angle in [-2 pi, 4 pi).
inline float wrapped(double angle_rad) {
  if (angle_rad < 0) angle_rad += kTwoPi;
  if (angle_rad >= kTwoPi) angle_rad -= kTwoPi;
  const auto angle = static_cast<float>(angle_rad);
  return angle < static_cast<float>(kTwoPi) ? angle : 0.0F;
}

/// Appends points to a packet's output; full output is counted by the caller, who gives room for the largest packet.
class PointSink {
 public:
  PointSink(std::span<SweepPoint> points, DecodedPacket& decoded, const ModelInfo& model)
      : points_(points), decoded_(decoded), min_range_m_(model.min_range_m), max_range_m_(model.max_range_m) {}

  std::size_t room() const { return points_.size() - decoded_.point_count; }
  /// False (and counted) for a range that no sensor of this model measures.
  bool plausible(double range_m) {
    if (range_m > 0 && range_m >= min_range_m_ && range_m <= max_range_m_) return true;
    ++decoded_.absurd_ranges;
    return false;
  }
  /// @pre room() > 0
  SweepPoint& add() { return points_[decoded_.point_count++]; }
  void end_block(uint16_t azimuth_cdeg, int32_t offset_ns) {
    static_cast<void>(
        decoded_.blocks.push_back({azimuth_cdeg, static_cast<uint16_t>(decoded_.point_count), offset_ns}));
  }

 private:
  std::span<SweepPoint> points_;
  DecodedPacket& decoded_;
  double min_range_m_, max_range_m_;
};

/// Position of a point whose azimuth grows from +y to +x (Velodyne, Hesai):
///   x = r cos(e) sin(a), y = r cos(e) cos(a), z = r sin(e), and the laser's own offsets.
inline void place_from_y(const Beam& beam, const Calibration::Trig& trig, const Direction& azimuth, double range_m,
                         SweepPoint& point) {
  const double xy = range_m * trig.cos_elevation - beam.vertical_offset_m * trig.sin_elevation;
  point.x_m = static_cast<float>(xy * azimuth.sin - beam.horizontal_offset_m * azimuth.cos);
  point.y_m = static_cast<float>(xy * azimuth.cos + beam.horizontal_offset_m * azimuth.sin);
  point.z_m = static_cast<float>(range_m * trig.sin_elevation + beam.vertical_offset_m * trig.cos_elevation);
}

/// Steps between the azimuths of a packet's blocks are even but for one jump (a field of view that is not the whole
/// turn) and make less than a turn in all; a flipped bit breaks that.
/// @param azimuth_cdeg  of the blocks, in firing order.
bool azimuths_plausible(std::span<const uint16_t> azimuth_cdeg);

/// Forward step from a to b, [0, 36000).
constexpr int forward_step_cdeg(int a, int b) { return (b - a + kTurnCdeg) % kTurnCdeg; }

}  // namespace roomcal::lidar
