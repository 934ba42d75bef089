#include "tools/bake/bundle.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <glog/logging.h>

#include "tools/bake/bundle_cost.h"

namespace roomcal::tools {

namespace {

/// W with W^T W = cov^-1.
Mat22 whitening_of(const Mat22& cov_px2) { return Mat22(cov_px2.inverse()).llt().matrixU(); }

class BundleProblem {
 public:
  BundleProblem(const Survey& survey, Reconstruction& map, const BundleOptions& options)
      : survey_(survey),
        map_(map),
        options_(options),
        given_rig_(options.given_rig.value_or(map.rig)),
        rig_(map.rig),
        poses_(map.views.size()),
        problem_(problem_options()) {
    for (std::size_t v = 0; v < map.views.size(); ++v) poses_[v] = PoseBlock(map.views[v].T_room_left);
    add_measurements();
    constrain_rig();
    hold_gauge();
  }

  BundleSummary solve() {
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    solver.linear_solver_ordering = ordering();
    solver.max_num_iterations = options_.max_iterations;
    solver.function_tolerance = 1e-9;
    solver.parameter_tolerance = 1e-10;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    FLAGS_minloglevel = google::GLOG_ERROR;  // a step that has to be tried again is no news
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem_, &summary);
    write_back();
    return {summary.termination_type == ceres::CONVERGENCE, static_cast<int>(summary.iterations.size()) - 1,
            summary.final_cost, static_cast<std::size_t>(problem_.NumResidualBlocks())};
  }

 private:
  ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.evaluation_callback = &rig_;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void add_measurements() {
    for (std::size_t v = 0; v < map_.views.size(); ++v) {
      if (!map_.views[v].placed) continue;
      for (const Side side : kBothSides) add_view_side(v, side);
    }
  }

  void add_view_side(std::size_t v, Side side) {
    const std::vector<int>& point = map_.views[v].point[side];
    const double sigma2 = options_.sigma_px[side] * options_.sigma_px[side];
    for (std::size_t s = 0; s < point.size(); ++s) {
      if (point[s] == kNoPoint) continue;
      const Sighting& sighting = survey_.views[v].seen[side][s];
      auto cost =
          std::make_unique<ReprojectionCost>(rig_, side, sighting.centre_px, whitening_of(sigma2 * sighting.cov_px2));
      problem_.AddResidualBlock(cost.release(), &loss_, poses_[v].x.data(),
                                map_.points[static_cast<std::size_t>(point[s])].p.data(), rig_.T_side_left(side),
                                rig_.intrinsics(side));
      problem_.SetManifold(poses_[v].x.data(), &manifold_);
      problem_.SetManifold(rig_.T_side_left(side), &manifold_);
    }
  }

  void constrain_rig() {
    for (const Side side : kBothSides) {
      double* T_side_left = rig_.T_side_left(side);
      if (!problem_.HasParameterBlock(T_side_left)) continue;
      const bool fixed = !options_.refine_rig;
      if (side == kLeft || fixed) problem_.SetParameterBlockConstant(T_side_left);
      if (fixed)
        problem_.SetParameterBlockConstant(rig_.intrinsics(side));
      else
        add_intrinsics_prior(side);
    }
    if (options_.refine_rig && problem_.HasParameterBlock(rig_.T_side_left(kRight))) add_rig_prior();
  }

  void add_intrinsics_prior(Side side) {
    const camera::Intrinsics& given = given_rig_.cameras[side].intrinsics();
    problem_.AddResidualBlock(make_intrinsics_prior(given, options_.prior).release(), nullptr, rig_.intrinsics(side));
    if (is_undistorted(given)) problem_.SetManifold(rig_.intrinsics(side), &no_distortion_);
  }

  void add_rig_prior() {
    problem_.AddResidualBlock(make_extrinsics_prior(given_rig_.T_right_left, options_.prior).release(), nullptr,
                              rig_.T_side_left(kRight));
  }

  void hold_gauge() {
    for (const std::size_t v : map_.order) {
      if (!problem_.HasParameterBlock(poses_[v].x.data())) continue;
      problem_.SetParameterBlockConstant(poses_[v].x.data());
      return;
    }
  }

  /// Views are eliminated first: there are more of them than points, and none shares a measurement with another.
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering() {
    auto groups = std::make_shared<ceres::ParameterBlockOrdering>();
    std::vector<double*> blocks;
    problem_.GetParameterBlocks(&blocks);
    std::vector<const double*> views;
    for (const PoseBlock& pose : poses_) views.push_back(pose.x.data());
    std::sort(views.begin(), views.end());
    for (double* block : blocks) {
      groups->AddElementToGroup(block, std::binary_search(views.begin(), views.end(), block) ? 0 : 1);
    }
    return groups;
  }

  void write_back() {
    map_.rig = rig_.rig();
    for (const std::size_t v : map_.order) map_.views[v].T_room_left = poses_[v].pose();
    const auto sights = collect_sights(map_);
    const double sigma_px = std::max(options_.sigma_px[kLeft], options_.sigma_px[kRight]);
    for (std::size_t p = 0; p < map_.points.size(); ++p) {
      if (!map_.alive[p] || sights[p].empty()) continue;
      SpacePoint again = map_.points[p];
      if (retriangulate(survey_, map_, sights[p], sigma_px, again)) map_.points[p].cov_m2 = again.cov_m2;
    }
  }

  const Survey& survey_;
  Reconstruction& map_;
  const BundleOptions& options_;
  StereoRig given_rig_;
  RigBlocks rig_;
  std::vector<PoseBlock> poses_;
  PoseManifold manifold_;
  ceres::SubsetManifold no_distortion_{camera::kIntrinsicsCount, {4, 5, 6, 7}};
  ceres::CauchyLoss loss_{options_.loss_sigmas};
  ceres::Problem problem_;  // last: it refers to all of the above
};

}  // namespace

BundleSummary bundle_adjust(const Survey& survey, Reconstruction& map, const BundleOptions& options) {
  return BundleProblem(survey, map, options).solve();
}

std::vector<double> residual_lengths(const Survey& survey, const Reconstruction& map, Side side) {
  std::vector<double> lengths_px;
  for (std::size_t v = 0; v < map.views.size(); ++v) {
    const ViewState& state = map.views[v];
    if (!state.placed) continue;
    const SE3 T_left_room = state.T_room_left.inverse();
    for (std::size_t s = 0; s < state.point[side].size(); ++s) {
      if (state.point[side][s] == kNoPoint) continue;
      Vec2 px;
      if (!map.rig.project(side, T_left_room * map.points[static_cast<std::size_t>(state.point[side][s])].p, px).ok())
        continue;
      lengths_px.push_back((px - survey.views[v].seen[side][s].centre_px).norm());
    }
  }
  return lengths_px;
}

std::array<double, 2> robust_sigma_px(const Survey& survey, const Reconstruction& map) {
  std::array<double, 2> sigma_px{1, 1};
  for (const Side side : kBothSides) {
    std::vector<double> lengths_px = residual_lengths(survey, map, side);
    if (lengths_px.empty()) continue;
    const auto middle = lengths_px.begin() + static_cast<std::ptrdiff_t>(lengths_px.size() / 2);
    std::nth_element(lengths_px.begin(), middle, lengths_px.end());
    sigma_px[side] = std::max(1e-3, *middle / 1.177);
  }
  return sigma_px;
}

}  // namespace roomcal::tools
