#pragma once

#include <cstddef>
#include <vector>

#include "tools/align/rigid_fit.h"
#include "tools/bake/survey.h"

namespace roomcal::tools {

inline constexpr int kNoPoint = -1;

/// What the reconstruction knows of one stop of the survey.
struct ViewState {
  bool placed = false;
  SE3 T_room_left;  ///< "room" is the reconstruction's own frame until the structure is known
  /// Map point of each sighting, or kNoPoint; as long as StereoView::seen.
  std::array<std::vector<int>, 2> point;
};

/// Points and stops in one frame. Points keep their number for life; removed ones are not `alive`.
struct Reconstruction {
  StereoRig rig;
  std::vector<ViewState> views;  ///< as many as the survey has
  std::vector<SpacePoint> points;
  std::vector<bool> alive;
  std::vector<std::size_t> order;  ///< numbers of the placed views, as they were placed

  std::size_t add_point(const SpacePoint& point) {
    points.push_back(point);
    alive.push_back(true);
    return points.size() - 1;
  }
  std::size_t alive_count() const;
};

/// One measurement of a point.
struct PointSight {
  std::size_t view = 0;
  Side side = kLeft;
  std::size_t sighting = 0;
};

/// All measurements of every point, by view.
std::vector<std::vector<PointSight>> collect_sights(const Reconstruction& map);

/// Number of stops in which a point was measured, in either image.
std::size_t count_views(const std::vector<PointSight>& sights);

/// An empty reconstruction with the survey's shape.
Reconstruction start_reconstruction(const StereoRig& rig, const Survey& survey);

/// Takes a view's sightings off their points and the view out of the map.
void unplace(Reconstruction& map, std::size_t view);

/// Gives every measurement of `gone` to `kept`. @return false, nothing changed, if both are in one image.
bool join_points(Reconstruction& map, std::size_t kept, std::size_t gone);

/// The same, but where both are in one image the sighting of `gone` is released.
void merge_points(Reconstruction& map, std::size_t kept, std::size_t gone);

/// Releases a point's sightings and takes it out of the map.
void remove_point(Reconstruction& map, std::size_t gone);

/// Position and covariance of a point from all its measurements, poses held.
/// @return false, nothing changed, where the rays do not fix it. Cost: four Gauss-Newton rounds.
bool retriangulate(const Survey& survey, const Reconstruction& map, const std::vector<PointSight>& sights,
                   double sigma_px, SpacePoint& point);

}  // namespace roomcal::tools
