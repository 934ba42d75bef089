#include "tests/benchmark/index_peers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <nanoflann.hpp>

namespace roomcal::tools {

namespace {

constexpr std::size_t kNear = 20;  // neighbours of a normal
constexpr int kRounds = 5;

/// Points as nanoflann asks for them.
struct Points {
  std::span<const Eigen::Vector3f> p;
  std::size_t kdtree_get_point_count() const { return p.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return p[i][static_cast<Eigen::Index>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Nanoflann = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3, uint32_t>;

/// Where a sweep's points come to lie in the room: as far off the map as noise takes them.
std::vector<Eigen::Vector3f> queries_of(const LidarRoom& room) {
  const LidarTrialSetup setup = set_up_lidar_trial(room, {});
  std::vector<Eigen::Vector3f> queries;
  const lidar::Sweep sweep = setup.sweep.view();
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    queries.push_back((setup.T_room_lidar * sweep.position_lidar(i)).cast<float>());
  }
  return queries;
}

/// Milliseconds of the quickest of some rounds.
template <typename Work>
double least_ms(const Work& work) {
  double least = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    const double start_ms = thread_cpu_ms();
    work();
    least = std::min(least, thread_cpu_ms() - start_ms);
  }
  return least;
}

/// Sums of distances: what both must agree in.
struct Answers {
  double nearest_m2 = 0, farthest_of_many_m2 = 0;
};

struct Figures {
  double build_ms = 0, nearest_ms = 0, many_ms = 0;
  Answers answers;
};

Figures measure_ours(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> queries) {
  Figures figures;
  std::vector<std::byte> bytes(scan::KdTree::bytes(points.size()));
  scan::KdTree tree;
  figures.build_ms = least_ms([&] {
    Arena arena{bytes};
    tree = scan::KdTree::build(points, arena).value();
  });
  figures.nearest_ms = least_ms([&] {
    figures.answers.nearest_m2 = 0;
    scan::KdTree::Near near;
    for (const Eigen::Vector3f& q : queries) {
      if (tree.nearest(q, 10, near)) figures.answers.nearest_m2 += static_cast<double>(near.squared_m2);
    }
  });
  figures.many_ms = least_ms([&] {
    figures.answers.farthest_of_many_m2 = 0;
    std::array<scan::KdTree::Near, kNear> near;
    for (const Eigen::Vector3f& q : queries) {
      tree.nearest(q, near);
      figures.answers.farthest_of_many_m2 += static_cast<double>(near.back().squared_m2);
    }
  });
  return figures;
}

Figures measure_nanoflann(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> queries) {
  Figures figures;
  const Points adapted{points};
  figures.build_ms = least_ms([&] { Nanoflann(3, adapted).buildIndex(); });
  const Nanoflann tree(3, adapted);
  std::array<uint32_t, kNear> index;
  std::array<float, kNear> squared_m2;
  figures.nearest_ms = least_ms([&] {
    figures.answers.nearest_m2 = 0;
    for (const Eigen::Vector3f& q : queries) {
      tree.knnSearch(q.data(), 1, index.data(), squared_m2.data());
      figures.answers.nearest_m2 += static_cast<double>(squared_m2[0]);
    }
  });
  figures.many_ms = least_ms([&] {
    figures.answers.farthest_of_many_m2 = 0;
    for (const Eigen::Vector3f& q : queries) {
      tree.knnSearch(q.data(), kNear, index.data(), squared_m2.data());
      figures.answers.farthest_of_many_m2 += static_cast<double>(squared_m2.back());
    }
  });
  return figures;
}

void print(const char* name, const Figures& figures, double queries) {
  std::printf("%-10s %10.2f ms %12.2f us %15.2f us\n", name, figures.build_ms, 1e3 * figures.nearest_ms / queries,
              1e3 * figures.many_ms / queries);
}

bool equal(double a, double b) { return std::abs(a - b) <= 1e-5 * b; }

}  // namespace

bool compare_indices(const LidarRoom& room) {
  const std::span<const Eigen::Vector3f> points = room.dense().points_room();
  const std::vector<Eigen::Vector3f> queries = queries_of(room);
  const Figures ours = measure_ours(points, queries), nano = measure_nanoflann(points, queries);
  const bool same = equal(ours.answers.nearest_m2, nano.answers.nearest_m2) &&
                    equal(ours.answers.farthest_of_many_m2, nano.answers.farthest_of_many_m2);
  std::printf("Index of the dense map, %zu points, asked at %zu points of a sweep; distances %s\n", points.size(),
              queries.size(), same ? "equal" : "DIFFER");
  std::printf("%-10s %13s %15s %18s\n", "", "built in", "nearest", "nearest 20");
  print("ours", ours, static_cast<double>(queries.size()));
  print("nanoflann", nano, static_cast<double>(queries.size()));
  return same;
}

}  // namespace roomcal::tools
