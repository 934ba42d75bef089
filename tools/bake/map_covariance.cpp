#include "tools/bake/map_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "tools/bake/bundle_cost.h"
#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr Index kIntrinsics = camera::kIntrinsicsCount;
constexpr Index kRigCount = 6 + 2 * kIntrinsics;  // T_right_left, left and right intrinsics

/// The normal equations of points (and the rig) with all views eliminated.
class ReducedInformation {
 public:
  ReducedInformation(const Survey& survey, const Reconstruction& map, const BundleOptions& options)
      : survey_(survey), map_(map), options_(options), rig_(map.rig), column_(map.points.size(), -1) {
    for (std::size_t p = 0; p < map.points.size(); ++p) {
      if (!map.alive[p]) continue;
      column_[p] = points_;
      points_ += 3;
    }
    S_ = MatrixXd::Zero(points_ + kRigCount, points_ + kRigCount);
    for (std::size_t v = 0; v < map.views.size(); ++v) {
      if (map.views[v].placed) add_view(v);
    }
    add_rig();
  }

  std::vector<Mat33> covariances() const {
    const MatrixXd G = gauge();
    const double weight = S_.diagonal().head(points_).mean();
    const MatrixXd regular = S_ + weight * G * G.transpose();
    const Eigen::LDLT<MatrixXd> solver(regular);
    if (solver.info() != Eigen::Success || !solver.isPositive()) {
      throw ToolError("the points of the map do not hang together; no covariance");
    }
    const MatrixXd inverse = solver.solve(MatrixXd::Identity(S_.rows(), S_.cols())) - G * G.transpose() / weight;
    std::vector<Mat33> covariances(column_.size(), Mat33::Zero());
    for (std::size_t p = 0; p < column_.size(); ++p) {
      if (column_[p] < 0) continue;
      const Mat33 block = inverse.block<3, 3>(column_[p], column_[p]);
      covariances[p] = 0.5 * (block + block.transpose());
    }
    return covariances;
  }

 private:
  /// Jacobian of a view's residuals: 6 columns of its pose, then all it touches, listed in `columns`.
  void add_view(std::size_t v) {
    MatrixXd J;
    std::vector<Index> columns;
    linearize(v, J, columns);
    const MatrixXd H = J.transpose() * J;
    const Index n = H.rows() - 6;
    const Mat66 H_view = H.topLeftCorner<6, 6>();
    const MatrixXd cross = H.bottomLeftCorner(n, 6);
    const MatrixXd reduced = H.bottomRightCorner(n, n) - cross * H_view.ldlt().solve(cross.transpose());
    for (Index r = 0; r < n; ++r) {
      for (Index c = 0; c < n; ++c)
        S_(columns[static_cast<std::size_t>(r)], columns[static_cast<std::size_t>(c)]) += reduced(r, c);
    }
  }

  void linearize(std::size_t v, MatrixXd& J, std::vector<Index>& columns) {
    std::vector<Index> place(map_.points.size(), -1);
    Index rows = 0;
    for (Index i = 0; i < kRigCount; ++i) columns.push_back(points_ + i);
    for (const Side side : kBothSides) {
      for (const int p : map_.views[v].point[side]) {
        if (p == kNoPoint) continue;
        rows += 2;
        Index& at = place[static_cast<std::size_t>(p)];
        if (at >= 0) continue;
        at = 6 + static_cast<Index>(columns.size());
        for (Index i = 0; i < 3; ++i) columns.push_back(column_[static_cast<std::size_t>(p)] + i);
      }
    }
    J = MatrixXd::Zero(rows, 6 + static_cast<Index>(columns.size()));
    Index row = 0;
    for (const Side side : kBothSides) {
      for (std::size_t s = 0; s < map_.views[v].point[side].size(); ++s) {
        const int p = map_.views[v].point[side][s];
        if (p == kNoPoint) continue;
        add_sighting(v, side, s, place[static_cast<std::size_t>(p)], J.middleRows(row, 2));
        row += 2;
      }
    }
  }

  void add_sighting(std::size_t v, Side side, std::size_t s, Index at, Eigen::Ref<MatrixXd> J) {
    const Sighting& sighting = survey_.views[v].seen[side][s];
    const Mat22 cov_px2 = options_.sigma_px[side] * options_.sigma_px[side] * sighting.cov_px2;
    const ReprojectionCost cost(rig_, side, sighting.centre_px, Mat22(cov_px2.inverse()).llt().matrixU());
    const PoseBlock T_room_left(map_.views[v].T_room_left);
    const double* parameters[4] = {T_room_left.x.data(),
                                   map_.points[static_cast<std::size_t>(map_.views[v].point[side][s])].p.data(),
                                   rig_.T_side_left(side), rig_.intrinsics(side)};
    RowMajor J_pose(2, 12), J_point(2, 3), J_side(2, 12), J_k(2, kIntrinsics);
    double* jacobians[4] = {J_pose.data(), J_point.data(), J_side.data(), J_k.data()};
    Vec2 residual;
    cost.Evaluate(parameters, residual.data(), jacobians);
    const double scale2 = options_.loss_sigmas * options_.loss_sigmas;
    const double root_weight = 1 / std::sqrt(1 + residual.squaredNorm() / scale2);
    J.leftCols<6>() = root_weight * J_pose.leftCols<6>();
    J.middleCols<3>(at) = root_weight * J_point;
    if (!options_.refine_rig) return;
    if (side == kRight) J.middleCols<6>(6) = root_weight * J_side.leftCols<6>();
    J.middleCols<kIntrinsics>(6 + 6 + static_cast<Index>(side) * kIntrinsics) = root_weight * J_k;
  }

  /// The prior; without refinement a unit diagonal, which its zero columns never mix with anything.
  void add_rig() {
    if (!options_.refine_rig) {
      S_.bottomRightCorner<kRigCount, kRigCount>().setIdentity();
      return;
    }
    const StereoRig given = options_.given_rig.value_or(map_.rig);
    add_prior(*make_extrinsics_prior(given.T_right_left, options_.prior), rig_.T_side_left(kRight), 6, 12, 6, points_);
    for (const Side side : kBothSides) {
      const camera::Intrinsics& k = given.cameras[side].intrinsics();
      const Index first = points_ + 6 + static_cast<Index>(side) * kIntrinsics;
      add_prior(*make_intrinsics_prior(k, options_.prior), rig_.intrinsics(side), kIntrinsics, kIntrinsics, kIntrinsics,
                first);
      if (is_undistorted(k)) S_.diagonal().segment<4>(first + 4).array() += 1e12;  // held
    }
  }

  void add_prior(const ceres::CostFunction& prior, const double* x, Index rows, Index ambient, Index tangent,
                 Index first) {
    RowMajor J(rows, ambient);
    Eigen::VectorXd residual(rows);
    double* jacobians[1] = {J.data()};
    const double* parameters[1] = {x};
    prior.Evaluate(parameters, residual.data(), jacobians);
    const MatrixXd J_tangent = J.leftCols(tangent);
    S_.block(first, first, tangent, tangent) += J_tangent.transpose() * J_tangent;
  }

  /// Orthonormal basis of what no measurement sees: the shift and turn of all points.
  MatrixXd gauge() const {
    MatrixXd G = MatrixXd::Zero(S_.rows(), 6);
    for (std::size_t p = 0; p < column_.size(); ++p) {
      if (column_[p] < 0) continue;
      G.block<3, 3>(column_[p], 0).setIdentity();
      G.block<3, 3>(column_[p], 3) = -hat(map_.points[p].p);
    }
    const Eigen::HouseholderQR<MatrixXd> qr(G);
    return qr.householderQ() * MatrixXd::Identity(S_.rows(), 6);
  }

  const Survey& survey_;
  const Reconstruction& map_;
  const BundleOptions& options_;
  RigBlocks rig_;
  std::vector<Index> column_;
  Index points_ = 0;  ///< columns of points
  MatrixXd S_;
};

}  // namespace

std::vector<Mat33> map_covariance(const Survey& survey, const Reconstruction& map, const BundleOptions& options) {
  return ReducedInformation(survey, map, options).covariances();
}

}  // namespace roomcal::tools
