#include "tools/evaluate/stereo_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "tools/common/error.h"

namespace roomcal::tools {
namespace {

// Shared parameters: left fx fy cx cy | right fx fy cx cy | T_right_left (right perturbation).
using Vec14 = Eigen::Matrix<double, 14, 1>;
using Mat14 = Eigen::Matrix<double, 14, 14>;
using Mat14x6 = Eigen::Matrix<double, 14, 6>;
using Row14 = Eigen::Matrix<double, 2, 14>;

struct Sample {
  Vec3 p_room;
  Vec2 left_px;
  Vec2 right_px;
};

struct Parameters {
  Vec4 left;
  Vec4 right;
  SE3 T_right_left;
  std::vector<SE3> T_room_left;  // a frame each
};

using FrameSamples = std::vector<std::vector<Sample>>;

constexpr double kCauchy_px = 1.0;  // twice the key points' noise: wrong correspondences lose their say

FrameSamples collect(const AnchorRoom& room) {
  FrameSamples frames;
  for (const AnchorFrame& frame : room.frames) {
    std::vector<Sample>& samples = frames.emplace_back();
    for (std::size_t k = 0; k < frame.point.size(); ++k) {
      if (frame.point[k] < 0) continue;
      const Vec3& p_room = room.point_room[static_cast<std::size_t>(frame.point[k])];
      // A map point behind the camera can only be a wrong correspondence.
      if ((frame.T_room_left.inverse() * p_room).z() > 0.1)
        samples.push_back({p_room, frame.left_px[k], frame.right_px[k]});
    }
  }
  return frames;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Vec2 project(const Vec4& k, const Vec3& p) { return {k[0] * p.x() / p.z() + k[2], k[1] * p.y() / p.z() + k[3]}; }

/// px = focal * (coordinate over depth) + centre, by least absolute residuals (reweighted): a start without a guess.
void fit_axis(const FrameSamples& frames, const Parameters& x, int axis, Vec4& k, bool right) {
  for (int round = 0; round < 30; ++round) {
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    Vec2 b = Vec2::Zero();
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const SE3 T_left_room = x.T_room_left[f].inverse();
      for (const Sample& s : frames[f]) {
        const Vec3 p_left = T_left_room * s.p_room;
        const Vec2 row(p_left[axis] / p_left.z(), 1.0);
        const double px = right ? s.right_px[axis] : s.left_px[axis];
        const double weight = round == 0 ? 1.0 : 1.0 / std::max(std::abs(k[axis] * row[0] + k[axis + 2] - px), 1.0);
        H += weight * row * row.transpose();
        b += weight * row * px;
      }
    }
    const Vec2 solution = H.ldlt().solve(b);
    k[axis] = solution[0];
    k[axis + 2] = solution[1];
  }
}

struct Residuals {
  Vec2 left;
  Vec2 right;
  Vec3 p_left;
  Vec3 p_right;
};

Residuals residuals(const Parameters& x, std::size_t frame, const Sample& s) {
  Residuals r;
  r.p_left = x.T_room_left[frame].R.transpose() * (s.p_room - x.T_room_left[frame].t);
  r.p_right = x.T_right_left * r.p_left;
  r.left = project(x.left, r.p_left) - s.left_px;
  r.right = project(x.right, r.p_right) - s.right_px;
  return r;
}

double cauchy(const Vec2& r) { return std::log1p(r.squaredNorm() / (kCauchy_px * kCauchy_px)); }

double cost(const Parameters& x, const FrameSamples& frames) {
  double sum = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (const Sample& s : frames[f]) {
      const Residuals r = residuals(x, f, s);
      sum += cauchy(r.left) + cauchy(r.right);
    }
  }
  return sum;
}

/// Normal equations of one frame: shared block, the frame's pose, and what couples them.
struct FrameNormal {
  Mat14 H = Mat14::Zero();
  Mat14x6 W = Mat14x6::Zero();
  Mat66 P = Mat66::Zero();
  Vec14 b = Vec14::Zero();
  Vec6 c = Vec6::Zero();

  void add(const Row14& J, const Mat26& J_pose, const Vec2& r) {
    const double weight = 1.0 / (1.0 + r.squaredNorm() / (kCauchy_px * kCauchy_px));
    H += weight * J.transpose() * J;
    W += weight * J.transpose() * J_pose;
    P += weight * J_pose.transpose() * J_pose;
    b -= weight * J.transpose() * r;
    c -= weight * J_pose.transpose() * r;
  }
};

Mat23 by_point(const Vec4& k, const Vec3& p) {
  Mat23 J;
  J << k[0] / p.z(), 0, -k[0] * p.x() / (p.z() * p.z()), 0, k[1] / p.z(), -k[1] * p.y() / (p.z() * p.z());
  return J;
}

void set_intrinsics_columns(const Vec3& p, int column, Row14& J) {
  J(0, column) = p.x() / p.z();
  J(1, column + 1) = p.y() / p.z();
  J(0, column + 2) = J(1, column + 3) = 1.0;
}

void linearize(const Parameters& x, std::size_t frame, const Sample& s, FrameNormal& normal) {
  const Residuals r = residuals(x, frame, s);
  Eigen::Matrix<double, 3, 6> p_left_by_pose;  // right perturbation of T_room_left
  p_left_by_pose << -Mat33::Identity(), hat(r.p_left);
  Row14 J = Row14::Zero();
  set_intrinsics_columns(r.p_left, 0, J);
  normal.add(J, by_point(x.left, r.p_left) * p_left_by_pose, r.left);
  J.setZero();
  set_intrinsics_columns(r.p_right, 4, J);
  const Mat23 by_p_left = by_point(x.right, r.p_right) * x.T_right_left.R;
  J.block<2, 3>(0, 8) = by_p_left;  // d p_right / d (rho, phi) = R [I, -hat(p_left)]
  J.block<2, 3>(0, 11) = -by_p_left * hat(r.p_left);
  normal.add(J, by_p_left * p_left_by_pose, r.right);
}

/// One damped step: the poses eliminated, the shared parameters solved, the poses found from them.
Parameters step(const Parameters& x, std::vector<FrameNormal> normals, double damping) {
  Mat14 H = Mat14::Zero();
  Vec14 b = Vec14::Zero();
  for (FrameNormal& n : normals) {
    n.P.diagonal() *= 1.0 + damping;
    n.P.diagonal().array() += 1e-9;  // a frame without samples stays where it is
    const Mat14x6 W_Pinv = n.P.ldlt().solve(n.W.transpose()).transpose();
    n.H.diagonal() *= 1.0 + damping;
    H += n.H - W_Pinv * n.W.transpose();
    b += n.b - W_Pinv * n.c;
  }
  const Vec14 d = H.ldlt().solve(b);
  Parameters next = x;
  next.left += d.head<4>();
  next.right += d.segment<4>(4);
  next.T_right_left = x.T_right_left * se3_exp(d.tail<6>());
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const Vec6 pose = normals[f].P.ldlt().solve(normals[f].c - normals[f].W.transpose() * d);
    next.T_room_left[f] = x.T_room_left[f] * se3_exp(pose);
  }
  return next;
}

Parameters minimize(Parameters x, const FrameSamples& frames) {
  double damping = 1e-3;
  double best = cost(x, frames);
  for (int round = 0; round < 100; ++round) {
    std::vector<FrameNormal> normals(frames.size());
    for (std::size_t f = 0; f < frames.size(); ++f) {
      for (const Sample& s : frames[f]) linearize(x, f, s, normals[f]);
    }
    const Parameters next = step(x, normals, damping);
    const double next_cost = cost(next, frames);
    if (std::isfinite(next_cost) && next_cost <= best) {
      const bool settled = best - next_cost < 1e-9 * best;
      x = next;
      best = next_cost;
      damping *= 0.2;
      if (settled) return x;
    } else {
      damping *= 10.0;
      if (damping > 1e12) break;
    }
  }
  throw ToolError("stereo fit: not converged: does the file's map belong to its frames?");
}

camera::Intrinsics intrinsics(const Vec4& k) {
  camera::Intrinsics out;
  out.fx_px = k[0];
  out.fy_px = k[1];
  out.cx_px = k[2];
  out.cy_px = k[3];
  // The file does not tell the size; the principal point of a camera is near its middle.
  out.width_px = static_cast<int>(std::lround(2.0 * k[2]));
  out.height_px = static_cast<int>(std::lround(2.0 * k[3]));
  return out;
}

}  // namespace

StereoPair fit_stereo_pair(const AnchorRoom& room) {
  const FrameSamples frames = collect(room);
  std::size_t count = 0;
  for (const std::vector<Sample>& samples : frames) count += samples.size();
  if (count < 100) throw ToolError("stereo fit: fewer than 100 key points have a map point");
  Parameters x;
  x.left.setZero();
  x.right.setZero();
  for (const AnchorFrame& frame : room.frames) x.T_room_left.push_back(frame.T_room_left);
  for (const int axis : {0, 1}) {
    fit_axis(frames, x, axis, x.left, false);
    fit_axis(frames, x, axis, x.right, true);
  }
  // Principal points are near each other; what separates the linear fits is the baseline's disparity.
  x.right.tail<2>() = x.left.tail<2>();
  x = minimize(x, frames);
  StereoPair pair;
  pair.left = intrinsics(x.left);
  pair.right = intrinsics(x.right);
  pair.T_right_left = x.T_right_left;
  std::vector<double> left;
  std::vector<double> right;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (const Sample& s : frames[f]) {
      const Residuals r = residuals(x, f, s);
      left.push_back(r.left.norm());
      right.push_back(r.right.norm());
    }
  }
  pair.median_left_px = median(left);
  pair.median_right_px = median(right);
  return pair;
}

}  // namespace roomcal::tools
