#include "runtime/calib/map_errors.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "runtime/map/plane_error.h"
#include "runtime/scan/plane_pull.h"

namespace roomcal::calib {

namespace {

/// By how much a sweep's information is too large, see believed().
double widening(const scan::Location& location) {
  constexpr double kThing_m = 0.7, kReach = 3, kMeanPull = 1.5;
  const double unknown = 1 - location.shares.explained;
  const double pull = unknown * (kReach * location.sigma_m / kThing_m) * kMeanPull;
  return 1 + pull * pull * static_cast<double>(location.inliers);
}

Status collect_planes(const map::RoomMap& map, Arena& step, Outcome& outcome) {
  bool any = false;
  for (std::size_t i = 0; i < map.plane_count() && !any; ++i) any = !map.plane(i).cov.isZero(0);
  if (!any) return ok_status();
  outcome.plane_cov = step.allocate<Mat33>(map.plane_count());
  if (outcome.plane_cov.empty()) return out_of_arena("step arena: no room for planes: reserve plan_memory()");
  for (std::size_t i = 0; i < map.plane_count(); ++i) outcome.plane_cov[i] = map.plane(i).cov;
  return ok_status();
}

/// Ties a plane to its markers, which it was fitted to by least squares of their distances: with levers a_i and errors
/// e_i its own is -(sum a a')^-1 sum a_i n . e_i.
void tie_plane(const map::MapPlane& plane, std::size_t number, const map::RoomMap& map,
               std::span<rig::Landmark> landmarks) {
  Mat33 AtA = Mat33::Zero();
  for (std::size_t m = 0; m < landmarks.size(); ++m) {
    if (map.marker(m).plane != static_cast<int>(number)) continue;
    const Vec3 lever = map::plane_lever(plane.normal_room, landmarks[m].p_room);
    AtA += lever * lever.transpose();
  }
  const Eigen::LLT<Mat33> by_fit(AtA), by_map(plane.cov);
  if (by_fit.info() != Eigen::Success || by_map.info() != Eigen::Success) return;
  Mat33 told = Mat33::Zero();  // of the plane's covariance, by its markers
  for (std::size_t m = 0; m < landmarks.size(); ++m) {
    if (map.marker(m).plane != static_cast<int>(number)) continue;
    const Vec3 lever = map::plane_lever(plane.normal_room, landmarks[m].p_room);
    rig::Landmark& landmark = landmarks[m];
    landmark.plane = static_cast<uint16_t>(number);
    landmark.plane_by_point = -by_fit.solve(lever) * plane.normal_room.transpose();
    told += landmark.plane_by_point * landmark.cov_m2 * landmark.plane_by_point.transpose();
  }
  // A map whose plane claims to be better than its markers make it was not fitted to them alone.
  const Mat33 half = by_map.matrixL().solve(told);
  const Mat33 share = by_map.matrixL().solve(half.transpose());
  const double largest = Eigen::SelfAdjointEigenSolver<Mat33>(share, Eigen::EigenvaluesOnly).eigenvalues()[2];
  if (!(largest > 1)) return;
  for (rig::Landmark& landmark : landmarks)
    if (landmark.plane == number) landmark.plane_by_point /= std::sqrt(largest);
}

/// The number of the plane that a face was made of; the map's plane_count() if it is of none.
std::size_t plane_of(const scan::Face& face, const map::RoomMap& map) {
  std::size_t i = 0;
  for (; i < map.plane_count(); ++i)
    if (const map::MapPlane plane = map.plane(i); plane.normal_room == face.normal_room && plane.d_m == face.d_m) break;
  return i;
}

}  // namespace

PoseInformation believed(const scan::Location& location) {
  PoseInformation points = location.information;
  const double widened = widening(location);
  points.information /= widened;
  points.gradient /= widened;
  return points;
}

Status collect_map(const Session& session, Arenas& arenas, Outcome& outcome) {
  outcome.landmarks = arenas.step.allocate<rig::Landmark>(session.map.marker_count());
  if (outcome.landmarks.empty()) return out_of_arena("step arena: no room for landmarks: reserve plan_memory()");
  for (std::size_t m = 0; m < outcome.landmarks.size(); ++m) {
    const map::MapMarker marker = session.map.marker(m);
    outcome.landmarks[m].p_room = marker.p_room;
    outcome.landmarks[m].cov_m2 = marker.cov_m2;
  }
  outcome.plane_cov = {};
  if (session.device.lidars.empty()) return ok_status();  // cameras see markers, not planes
  ROOMCAL_TRY(collect_planes(session.map, arenas.step, outcome));
  for (std::size_t i = 0; i < outcome.plane_cov.size(); ++i)
    if (!outcome.plane_cov[i].isZero(0)) tie_plane(session.map.plane(i), i, session.map, outcome.landmarks);
  return ok_status();
}

Status collect_pulls(const Session& session, std::size_t lidar, const Sweeps& sweeps, Arenas& arenas,
                     Outcome& outcome) {
  if (outcome.plane_cov.empty()) return ok_status();
  LidarOutcome& of = outcome.lidars[lidar];
  const std::span<rig::PlanePull> room = arenas.step.allocate<rig::PlanePull>(rig::kMaxPulls);
  if (room.empty()) return out_of_arena("step arena: no room for planes: reserve plan_memory()");
  const Arena::Scope scope(arenas.step);
  std::span<lidar::Sweep> clean;
  ROOMCAL_TRY(clean_sweeps(sweeps, arenas.step, clean));
  scan::FacePulls pulls;
  ROOMCAL_TRY(scan::find_face_pulls(*session.surface, clean, session.device.lidars[lidar].ranges, of.location,
                                    arenas.scratch, pulls));
  std::size_t count = 0;
  for (const scan::FacePull& pull : pulls) {
    const std::size_t plane = plane_of(session.surface->faces()[pull.face], session.map);
    if (plane < outcome.plane_cov.size())
      room[count++] = {static_cast<uint16_t>(plane), pull.pull / widening(of.location)};
  }
  of.pulls = room.first(count);
  return ok_status();
}

}  // namespace roomcal::calib
