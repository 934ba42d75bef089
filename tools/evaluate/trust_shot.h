#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/calib/memory_plan.h"
#include "runtime/calib/session.h"
#include "tools/common/random.h"
#include "tools/evaluate/scene_map.h"
#include "tools/simulate/lidar_sweep.h"
#include "tools/simulate/shot.h"

namespace roomcal::tools {

/// A simulated room with its map, and what a session wants of it.
class TrustRoom {
 public:
  /// The usual room of this seed.
  explicit TrustRoom(uint64_t seed);
  /// A room and its own map.
  explicit TrustRoom(Scene scene);
  /// What has become of a room since its map was made.
  TrustRoom(Scene scene, MapData map);

  const Scene& scene() const { return *scene_; }
  const SweepSimulator& simulator() const { return *simulator_; }
  const MapData& data() const { return data_; }

 private:
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<SweepSimulator> simulator_;
  MapData data_;
};

/// The paper's robot with two VLP-16 leaning so that both see floor and walls: sensors' true poses in the rig.
struct TrustDevice {
  calib::Device device;                            ///< as provisioned: nominal mountings, lenses
  std::vector<camera::Camera> lenses;              ///< the cameras' true ones
  std::vector<SE3> T_rig_sensor;                   ///< cameras, then LiDARs; the first camera is the rig
  std::vector<std::vector<double>> beam_offset_m;  ///< per LiDAR: the units' own

  std::size_t sensors() const { return T_rig_sensor.size(); }
  std::string name(std::size_t sensor) const;
  /// @throws ToolError for a name that no sensor has.
  std::size_t number_of(std::string_view name) const;
};
struct TrustDeviceOptions {
  bool refine_intrinsics = false;  ///< the provisioned lenses are off by a draw from their prior, and are refined along
  double scale = 1;                ///< of the cameras' resolution
};
TrustDevice make_trust_device(const TrustRoom& room, uint64_t seed, const TrustDeviceOptions& options = {});

/// A place in the room where this device may stand: the reference camera's pose.
SE3 place_trust_device(const TrustRoom& room, uint64_t seed);

/// What every sensor sees of a room, at the level of observations: ring centres with their noise, sweeps.
struct TrustShot {
  std::vector<std::vector<marker::Detection>> rings;
  std::vector<SimulatedSweep> sweeps;
};
/// What is wrong with LiDARs in one shot.
struct TrustFlaws {
  struct OfLidar {
    double blocked_from_rad = 0, blocked_to_rad = 0;  ///< azimuths at which something stands before it
    double dropout = 0;                               ///< share of firings without a return
  };
  std::vector<OfLidar> lidars = {};  ///< may be shorter than the device's: the others have none
  OfLidar of(std::size_t lidar) const { return lidar < lidars.size() ? lidars[lidar] : OfLidar(); }
};
TrustShot take_trust_shot(const TrustRoom& room, const TrustDevice& device, const SE3& T_room_rig,
                          const TrustFlaws& flaws, Random& random);
/// Of a ring centre, per axis: what the detector reaches on markers of 40 px.
inline constexpr double kRingSigma_px = 0.03;
/// Rings of one camera only: of sheets and of their images in mirrors, where there is light.
/// @param typical_sigma_px  each ring has 0.7 to 1.5 of it and says so
std::vector<marker::Detection> see_rings(const TrustRoom& room, const camera::Camera& camera, const SE3& T_room_cam,
                                         Random& random, double typical_sigma_px = kRingSigma_px);
/// A lens as its own calibration left it.
camera::Camera given_lens(const camera::Camera& truth, const camera::IntrinsicsSigma& sigma, Random& random);

/// The runtime's view of a shot, which must outlive it.
class TrustShotView {
 public:
  explicit TrustShotView(TrustShot& shot);
  calib::DetectedShot shot() const { return {rings_, sweeps_}; }

 private:
  std::vector<std::span<marker::Detection>> rings_;
  std::vector<lidar::Sweep> views_;
  std::vector<calib::Sweeps> sweeps_;
};

/// Arms a session with a map and runs shots through it.
class TrustSession {
 public:
  TrustSession(const calib::Device& device, const MapData& map);
  TrustSession(const TrustSession&) = delete;  // its session refers to its members
  TrustSession& operator=(const TrustSession&) = delete;

  const calib::Outcome& run(TrustShot& shot, const store::Record* installed);
  /// calibrate() and nothing else: no heap call.
  Status calibrate(const calib::DetectedShot& shot, const store::Record* installed,
                   calib::Observer* observer = nullptr);
  /// The same from pictures.
  Status calibrate(const calib::Shot& shot);
  const calib::Outcome& outcome() const { return *outcome_; }
  /// What shots are calibrated with.
  const calib::Session& session() const { return session_; }
  const map::RoomMap& map() const { return map_.map; }
  calib::Session session(const store::Record* installed) const;

 private:
  void rewind() { arenas_.step = Arena(std::span(block_).subspan(plan_.permanent_bytes, plan_.step_bytes)); }

  LoadedMap map_;
  const calib::Device& device_;
  calib::MemoryPlan plan_;
  std::vector<std::byte> block_;
  Arenas arenas_;
  map::TriangleIndex index_;
  scan::Surface surface_;
  calib::Session session_;
  std::unique_ptr<calib::Outcome> outcome_ = std::make_unique<calib::Outcome>();
};

}  // namespace roomcal::tools
