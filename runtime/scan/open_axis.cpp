#include "runtime/scan/open_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "runtime/scan/observability.h"
#include "runtime/scan/ray_cast.h"

namespace roomcal::scan {

namespace {

constexpr double kOpenSigma_m = 0.01;  // an axis that the points fix worse is open
constexpr double kMaxReach_m = 1;
constexpr double kStep_m = 0.01;    // height times 4 is range where a beam grazes the floor: within 3 sigmas
constexpr double kStays_m = 0.004;  // a prediction that moves by less does not change
constexpr double kBetter = 60;      // sigmas^2: a ray at an edge that changes sides is worth 24
constexpr int kMoves = 3;
constexpr double kTurnOver = 3;

SE3 moved_along(const SE3& T, const Vec3& axis_room, double shift_m) { return {T.R, T.t + shift_m * axis_room}; }

/// Collects rays in blocks; when they are full, every second goes and only every second is taken from then on.
class Collector {
 public:
  explicit Collector(std::span<RayBlock> blocks) : blocks_(blocks) {}

  void add(const RayBlock& from, std::size_t i) {
    if (offered_++ % every_ != 0) return;
    if (count_ == blocks_.size() * kBlockRays) thin_out();
    copy(from, i, count_++);
  }

  std::span<const RayBlock> close() {
    const std::size_t used = (count_ + kBlockRays - 1) / kBlockRays;
    for (std::size_t b = 0; b < used; ++b) {
      blocks_[b].count = static_cast<uint32_t>(std::min(kBlockRays, count_ - b * kBlockRays));
      close_block(blocks_[b]);
    }
    return blocks_.first(used);
  }
  std::size_t every() const { return every_; }

 private:
  void copy(const RayBlock& from, std::size_t i, std::size_t to) {
    RayBlock& block = blocks_[to / kBlockRays];
    const std::size_t k = to % kBlockRays;
    block.x[k] = from.x[i];
    block.y[k] = from.y[i];
    block.z[k] = from.z[i];
    block.range_m[k] = from.range_m[i];
    block.beam[k] = from.beam[i];
    block.reflectivity[k] = from.reflectivity[i];
  }
  void thin_out() {
    for (std::size_t k = 0; 2 * k < count_; ++k) copy(blocks_[2 * k / kBlockRays], 2 * k % kBlockRays, k);
    count_ = (count_ + 1) / 2;
    every_ *= 2;
  }

  std::span<RayBlock> blocks_;
  std::size_t count_ = 0, offered_ = 0, every_ = 1;
};

/// Rays whose prediction is not the same all along the axis, as far as five places show.
void collect_changing(const SweepView& view, const OpenAxis& open, const RefineInput& input, const SE3& T,
                      std::span<PosedSurface> posed, Collector& changing) {
  constexpr std::array<double, AxisScratch::kPlaces> kParts = {0, -1, -0.5, 0.5, 1};
  for (std::size_t k = 0; k < kParts.size(); ++k) {
    posed[k].set(input.surface, moved_along(T, open.axis_room, kParts[k] * open.reach_m));
  }
  std::array<bool, kFaceRows> moves{};
  for (std::size_t i = 0; i < input.surface.faces().size(); ++i) {
    moves[i] = std::abs(input.surface.faces()[i].normal_room.dot(open.axis_room)) * open.reach_m > kStays_m;
  }
  BlockHits here, there;
  std::array<bool, kBlockRays> changes;
  for_each_block(view, input.sensor, 1, [&](const RayBlock& block) {
    posed[0].cast(block, here);
    for (std::size_t i = 0; i < kBlockRays; ++i) changes[i] = moves[static_cast<std::size_t>(here.face[i])];
    for (std::size_t k = 1; k < posed.size(); ++k) {
      posed[k].cast(block, there);
      for (std::size_t i = 0; i < kBlockRays; ++i) changes[i] = changes[i] || here.face[i] != there.face[i];
    }
    for (std::size_t i = 0; i < block.count; ++i) {
      if (changes[i]) changing.add(block, i);
    }
  });
}

double prior_cost(const RefineInput& input, const SE3& T) {
  if (input.prior == nullptr) return 0;
  const Vec6 off = se3_log(input.prior->T_room_lidar.inverse() * T);
  return off.dot(input.prior->cov.llt().solve(off));
}

/// The shift at which the rays fit best; 0 if none is better than where the state is.
double best_shift(std::span<const RayBlock> rays, double weight, const OpenAxis& open, const RefineInput& input,
                  const RangeState& state) {
  const PassOptions pass{input.sigma_m, kTurnOver, 0, false};
  const auto cost_at = [&](double shift_m) {
    RangeState moved = state;
    moved.T_room_lidar = moved_along(state.T_room_lidar, open.axis_room, shift_m);
    return weight * total_loss(input.surface, rays, input.sensor, moved, pass) + prior_cost(input, moved.T_room_lidar);
  };
  const int steps = static_cast<int>(open.reach_m / kStep_m);
  double best_m = 0, least = cost_at(0) - kBetter;
  for (int step = -steps; step <= steps; ++step) {
    const double cost = cost_at(kStep_m * step);
    if (cost >= least) continue;
    least = cost;
    best_m = kStep_m * step;
  }
  return best_m;
}

}  // namespace

OpenAxis open_axis_of(const Mat66& information, const Mat33& R, const PosePrior* prior, double unknown_reach_m) {
  const Eigen::SelfAdjointEigenSolver<Mat33> axes(R * covariance_of(information).topLeftCorner<3, 3>() * R.transpose());
  OpenAxis open;
  open.axis_room = axes.eigenvectors().col(2);
  open.sigma_m = std::sqrt(std::max(0.0, axes.eigenvalues()[2]));
  open.open = open.sigma_m >= kOpenSigma_m;
  open.reach_m = unknown_reach_m;
  if (prior != nullptr) {
    const Vec3 axis_lidar = R.transpose() * open.axis_room;
    const double sigma_m = std::sqrt(axis_lidar.dot(prior->cov.topLeftCorner<3, 3>() * axis_lidar));
    open.reach_m = std::min(kMaxReach_m, 3 * sigma_m);
  }
  return open;
}

Status AxisScratch::build(Arena& arena, AxisScratch& scratch) {
  scratch.rays = arena.allocate_uninitialized<RayBlock>(kBlocks);
  scratch.posed = arena.allocate<PosedSurface>(kPlaces);
  if (scratch.rays.empty() || scratch.posed.empty()) return out_of_arena("scan: scratch arena too small for a search");
  return ok_status();
}

void search_axis(const SweepView& view, const OpenAxis& open, const AxisScratch& scratch, FineSolution& fine,
                 RefineInput& input) {
  for (int move = 0; move < kMoves; ++move) {
    Collector changing(scratch.rays);
    collect_changing(view, open, input, fine.state.T_room_lidar, scratch.posed, changing);
    const std::span<const RayBlock> blocks = changing.close();
    const double shift_m = best_shift(blocks, static_cast<double>(changing.every()), open, input, fine.state);
    if (shift_m == 0) return;
    FineSolution tried = fine;
    RefineInput tried_input = input;
    tried_input.mute = 0;
    tried.state.T_room_lidar = moved_along(fine.state.T_room_lidar, open.axis_room, shift_m);
    refine_fully(view, tried_input, tried);
    const double cost = cost_of(fine.sums, input, fine.linearized_at);
    if (cost_of(tried.sums, tried_input, tried.linearized_at) > cost - kBetter) return;
    fine = tried;
    input.mute = tried_input.mute;
  }
}

}  // namespace roomcal::scan
