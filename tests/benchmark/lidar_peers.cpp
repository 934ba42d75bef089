// One VLP-16 sweep after the other, located by us, by our Generalized ICP and by PCL's: what was found, how far off
// over the Cramer-Rao bound, and how long it took, as ratios. Then our index of the dense map beside nanoflann's.
// Built and run by tests/benchmark/peers, only where PCL and nanoflann are; never by tests.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>

#include "tests/benchmark/index_peers.h"
#include "tools/evaluate/lidar_bars.h"

namespace roomcal::tools {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Gicp = pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;

/// PCL's Generalized ICP as it is commonly used: the sweep thinned to one point in 5 cm, correspondences within 1 m and
/// then within 0.1 m, covariances of 20 neighbours. The dense map's part is made once, outside the time.
class PclPeer {
 public:
  explicit PclPeer(const LidarRoom& room) : target_(new Cloud) {
    for (const Eigen::Vector3f& p : room.dense().points_room()) target_->push_back({p.x(), p.y(), p.z()});
    gicp_.setInputTarget(target_);
    gicp_.setCorrespondenceRandomness(20);
    gicp_.setTransformationEpsilon(1e-5);
    gicp_.setRotationEpsilon(1e-5);
    gicp_.setInputSource(target_);
    Cloud unused;
    gicp_.setMaximumIterations(1);
    gicp_.align(unused);  // computes the map's covariances
  }

  LidarTrial run(const LidarTrialSpec& spec, const LidarTrialSetup& setup) {
    const double start_ms = thread_cpu_ms();
    gicp_.setInputSource(thinned(setup.sweep));
    const Eigen::Matrix4f coarse = align(setup.prior.T_room_lidar.matrix().cast<float>(), 1.0);
    const Eigen::Matrix4f fine = align(coarse, 0.1);
    const double ms = thread_cpu_ms() - start_ms;
    scan::Location location;
    location.outcome = gicp_.hasConverged() ? scan::LocateOutcome::kLocated : scan::LocateOutcome::kRefused;
    location.T_room_lidar = SE3::from_matrix(fine.cast<double>());
    location.cov = Mat66::Identity();  // it has none
    return judge_lidar_trial(spec, setup, location, ms);
  }

 private:
  static Cloud::Ptr thinned(const SimulatedSweep& sweep) {
    Cloud::Ptr all(new Cloud), few(new Cloud);
    for (const lidar::SweepPoint& p : sweep.points) all->push_back({p.x_m, p.y_m, p.z_m});
    pcl::VoxelGrid<pcl::PointXYZ> grid;
    grid.setLeafSize(0.05F, 0.05F, 0.05F);
    grid.setInputCloud(all);
    grid.filter(*few);
    return few;
  }

  Eigen::Matrix4f align(const Eigen::Matrix4f& T_room_lidar, double reach_m) {
    gicp_.setMaxCorrespondenceDistance(reach_m);
    gicp_.setMaximumIterations(60);
    Cloud unused;
    gicp_.align(unused, T_room_lidar);
    return gicp_.getFinalTransformation();
  }

  Cloud::Ptr target_;
  Gicp gicp_;
};

struct Row {
  const char* name;
  LidarCell cell;

  double median_ms() const {
    std::vector<double> ms = cell.ms;
    std::sort(ms.begin(), ms.end());
    return ms[ms.size() / 2];
  }
};
using Rows = std::array<Row, 3>;  ///< ours first

Rows locate_all(const LidarRoom& room, int poses, uint64_t seed) {
  PclPeer pcl(room);
  Rows rows = {{{"ours", {}}, {"our GICP", {}}, {"PCL GICP", {}}}};
  for (const Tilt tilt : {Tilt::kUpright, Tilt::kTilted, Tilt::kSteep}) {
    for (int i = 0; i < poses; ++i) {
      LidarTrialSpec spec;
      spec.tilt = tilt;
      spec.seed = seed + static_cast<uint64_t>(i);
      spec.use_reflectivity = false;
      rows[0].cell.add(run_lidar_trial(room, spec));
      spec.method = LidarMethod::kGicp;
      rows[1].cell.add(run_lidar_trial(room, spec));
      rows[2].cell.add(pcl.run(spec, set_up_lidar_trial(room, spec)));
    }
  }
  return rows;
}

void print(const Rows& rows) {
  const LidarCell& ours = rows[0].cell;
  std::printf("VLP-16 sweeps of 28,800 points, sigma 15 mm, beam offsets 10 mm; 3 x 4 x 2.7 m with a pillar\n");
  std::printf("start off by 0.2 m and 10 deg; found: of observable poses, within 30 mm and 0.5 deg; RMS of these\n");
  std::printf("processor time of one core, median; the dense map (5 cm) and its covariances made before\n\n");
  std::printf("%-10s %13s %22s %21s %20s\n", "", "found", "RMS over bound", "over ours", "time");
  std::printf("%-10s %13s %11s %10s %10s %10s %9s %10s\n", "", "", "position", "rotation", "position", "rotation", "ms",
              "over ours");
  for (const Row& row : rows) {
    const double position = row.cell.position_ratio(), rotation = row.cell.rotation_ratio();
    std::printf("%-10s %5d of %4d %11.2f %10.2f %10.1f %10.1f %9.1f %10.1f\n", row.name, row.cell.found,
                row.cell.observable, position, rotation, position / ours.position_ratio(),
                rotation / ours.rotation_ratio(), row.median_ms(), row.median_ms() / rows[0].median_ms());
  }
  std::printf("\n");
}

bool ours_is_best(const Rows& rows) {
  const LidarCell& ours = rows[0].cell;
  return std::all_of(rows.begin() + 1, rows.end(), [&](const Row& peer) {
    return ours.found >= peer.cell.found && ours.position_ratio() <= peer.cell.position_ratio() &&
           ours.rotation_ratio() <= peer.cell.rotation_ratio() && rows[0].median_ms() <= peer.median_ms();
  });
}

int compare(int poses, uint64_t seed) {
  const LidarRoom room(LidarSeeds{}.room);
  const Rows rows = locate_all(room, poses, seed);
  print(rows);
  const bool best = ours_is_best(rows);
  std::printf("%s ours finds the most, nearest to the truth, in the least time\n\n", best ? "met    " : "NOT MET");
  const bool same = compare_indices(room);
  return best && same ? 0 : 2;
}

}  // namespace
}  // namespace roomcal::tools

int main(int argc, char** argv) {
  const int poses = argc > 1 ? std::max(1, std::atoi(argv[1])) : 60;
  const uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : roomcal::tools::LidarSeeds{}.pose;
  return roomcal::tools::compare(poses, seed);
}
