#include "tools/report/report_sweeps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "runtime/calib/lidar_models.h"
#include "runtime/scan/ray_block.h"
#include "runtime/scan/ray_cast.h"
#include "runtime/scan/sweep_view.h"
#include "tools/common/error.h"
#include "tools/map/room_json.h"

namespace roomcal::tools {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kBins = 60;
constexpr double kReachSigmas = 4;  // of the histogram, to either side

/// The map's surface in memory of its own.
class RoomSurface {
 public:
  explicit RoomSurface(const map::RoomMap& map)
      : permanent_bytes_(scan::Surface::bytes(map.plane_count(), map.marker_count())),
        scratch_bytes_(2 * sizeof(Vec3) * (map.marker_count() + scan::kMaxFaceEdges) + 4096) {
    Arena permanent(permanent_bytes_), scratch(scratch_bytes_);
    Result<scan::Surface> built = scan::Surface::build(map, {}, permanent, scratch);
    require(built.status(), "--map");
    surface_ = built.value();
  }
  const scan::Surface& surface() const { return surface_; }

 private:
  std::vector<std::byte> permanent_bytes_, scratch_bytes_;
  scan::Surface surface_;
};

constexpr int kNone = -1;

struct Residual {
  int face = kNone;
  double m = 0;
};
using Residuals = std::array<Residual, scan::kBlockRays>;

/// Rays of one LiDAR against the room.
class Prediction {
 public:
  Prediction(const SensorResult& sensor, const map::RoomMap* map) : sensor_(sensor) {
    if (map == nullptr || map->plane_count() == 0) return;
    room_ = std::make_unique<RoomSurface>(*map);
    posed_ = std::make_unique<scan::PosedSurface>();
    posed_->set(room_->surface(), *sensor.T_room_sensor);
  }

  bool known() const { return room_ != nullptr; }
  /// Of each ray that meets a face from its front.
  Residuals of(const scan::RayBlock& block) const {
    Residuals residuals;
    if (!known()) return residuals;
    scan::BlockHits hits;
    posed_->cast(block, hits);
    for (std::size_t i = 0; i < block.count; ++i) {
      const auto face = static_cast<std::size_t>(hits.face[i]);
      if (posed_->height_m()[face] <= 0) continue;  // nothing, or a back that no sensor in the room sees
      const double told_m = static_cast<double>(block.range_m[i]) - sensor_.lidar->beam_offset_m[block.beam[i]];
      residuals[i] = {hits.face[i], told_m - 1 / static_cast<double>(hits.inverse_m[i])};
    }
    return residuals;
  }
  Json normals() const {
    Json normals = Json::array();
    if (known())
      for (const scan::Face& face : room_->surface().faces()) normals.push_back(rounded(face.normal_room));
    return normals;
  }

 private:
  const SensorResult& sensor_;
  std::unique_ptr<RoomSurface> room_;
  std::unique_ptr<scan::PosedSurface> posed_;
};

class Histogram {
 public:
  explicit Histogram(double sigma_m) : low_m_(-kReachSigmas * sigma_m), step_m_(-2 * low_m_ / kBins) {}
  void add(const Residual& residual) {
    const double bin = std::floor((residual.m - low_m_) / step_m_);
    if (residual.face == kNone || bin < 0 || bin >= kBins)
      ++outside_;
    else
      ++counts_[static_cast<std::size_t>(bin)];
  }
  Json json() const {
    return {{"low_mm", 1e3 * low_m_}, {"step_mm", 1e3 * step_m_}, {"counts", counts_}, {"outside", outside_}};
  }

 private:
  double low_m_, step_m_;
  std::array<uint32_t, kBins> counts_{};
  uint32_t outside_ = 0;
};

std::vector<lidar::Sweep> views_of(const std::vector<LoadedSweep>& sweeps, std::size_t count) {
  std::vector<lidar::Sweep> views;
  for (std::size_t i = 0; i < std::min(count, sweeps.size()); ++i) views.push_back(sweeps[i].view());
  return views;
}

Vec3 point_lidar(const scan::RayBlock& block, std::size_t i) {
  return static_cast<double>(block.range_m[i]) * block.direction_lidar(i);
}

void add_point(const Vec3& p_room, const Residual& residual, Json& out) {
  for (const double v : {p_room.x(), p_room.y(), p_room.z()}) out["points_mm"].push_back(std::lround(1e3 * v));
  const bool meets = residual.face != kNone;
  out["residual_mm"].push_back(meets ? Json(std::round(1e4 * residual.m) / 10) : Json());
  out["face"].push_back(residual.face);
}

}  // namespace

Json sweep_json(const LocatedSweeps& located, const map::RoomMap* map, std::size_t wanted) {
  const scan::SensorModel& ranges = *calib::ranges_of(located.sensor->lidar->model);
  const double told_m = located.sensor->lidar->sigma_m;
  const double sigma_m = told_m > 0 ? told_m : ranges.sigma_m;
  const std::vector<lidar::Sweep> views = views_of(*located.sweeps, located.sweeps->size());
  const scan::SweepView all{views};
  const Prediction prediction(*located.sensor, map);
  Histogram histogram(sigma_m);
  Json out = {{"sigma_m", sigma_m},
              {"normals", prediction.normals()},
              {"points_mm", Json::array()},
              {"residual_mm", Json::array()},
              {"face", Json::array()}};
  std::size_t points = 0;
  const std::size_t stride = scan::fair_stride(scan::stride_for(all, wanted));
  scan::for_each_block(all, ranges, 1, [&](const scan::RayBlock& block) {
    const Residuals residuals = prediction.of(block);
    for (std::size_t i = 0; i < block.count; ++i) {
      histogram.add(residuals[i]);
      if (points++ % stride == 0) add_point(*located.sensor->T_room_sensor * point_lidar(block, i), residuals[i], out);
    }
  });
  out["points"] = points;
  if (prediction.known()) out["histogram"] = histogram.json();
  return out;
}

Json projection_json(const SensorResult& camera, const LocatedSweeps& located, std::size_t wanted) {
  const scan::SensorModel& ranges = *calib::ranges_of(located.sensor->lidar->model);
  const camera::Intrinsics& k = camera.camera->intrinsics();
  const SE3 T_cam_lidar = camera.T_room_sensor->inverse() * *located.sensor->T_room_sensor;
  const std::vector<lidar::Sweep> views = views_of(*located.sweeps, 1);
  std::vector<Vec3> seen;  // u, v px, distance m
  scan::for_each_block({views}, ranges, 1, [&](const scan::RayBlock& block) {
    for (std::size_t i = 0; i < block.count; ++i) {
      const Vec3 p_cam = T_cam_lidar * point_lidar(block, i);
      Vec2 px;
      if (!camera.camera->project(p_cam, px).ok()) continue;
      if (px.x() < -0.5 || px.y() < -0.5 || px.x() > k.width_px - 0.5 || px.y() > k.height_px - 0.5) continue;
      seen.emplace_back(px.x(), px.y(), p_cam.norm());
    }
  });
  Json out = Json::array();
  const std::size_t stride = scan::fair_stride(seen.size() / std::max<std::size_t>(1, wanted));
  for (std::size_t i = 0; i < seen.size(); i += stride) {
    out.push_back(std::lround(seen[i].x()));
    out.push_back(std::lround(seen[i].y()));
    out.push_back(std::lround(100 * seen[i].z()));
  }
  return out;
}

}  // namespace roomcal::tools
