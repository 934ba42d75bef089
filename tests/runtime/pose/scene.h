#pragma once

#include <vector>

#include "runtime/map/triangle_index.h"
#include "runtime/pose/locate_camera.h"
#include "tests/truth/synthetic_room.h"

namespace roomcal::pose {

/// A room as a map: exact or with noise, with or without normals and radius, and its index.
struct MapScene {
  std::vector<map::MapMarker> markers;
  std::vector<map::MarkerTriple> triples;
  std::vector<std::byte> bytes;
  map::TriangleIndex index;
};

struct MapSceneOptions {
  bool sizes = true;   ///< radius and normals known
  double sigma_m = 0;  ///< noise of the map's points, declared in their covariance
};

inline constexpr double kRadius_m = 0.085;

MapScene make_map_scene(const std::vector<truth::RoomMarker>& room, const MapSceneOptions& options, uint64_t seed);

struct ShotOptions {
  double sigma_px = 0.05;
  double missed = 0.2;        ///< part of the markers in view that is not seen
  double false_alarms = 0.2;  ///< added, as a part of those seen
  bool ellipses = true;
  std::size_t most = 1000;  ///< of the markers in view
};

/// What a camera sees: marker number, or -1 for a false alarm, beside each observation.
struct ImageScene {
  std::vector<Observation> observations;
  std::vector<int> marker;
};
ImageScene make_image_scene(const std::vector<truth::RoomMarker>& room, const camera::Camera& camera,
                            const SE3& T_room_cam, const ShotOptions& options, truth::Random& random);

/// locate_camera() with arenas of exactly the stated sizes.
struct Located {
  Status status;
  CameraLocation location;
  std::vector<Correspondence> inliers;
};
Located locate(const camera::Camera& camera, const std::vector<Observation>& observations,
               const map::TriangleIndex& index, const LocateOptions& options = {});

}  // namespace roomcal::pose
