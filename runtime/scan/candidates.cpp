#include "runtime/scan/candidates.h"

#include <algorithm>

namespace roomcal::scan {

namespace {

constexpr double kTurnOver = 3;                   // sigmas
constexpr double kOtherPlace = 150;               // squared distance in sigmas of the sample
constexpr double kNear_m = 0.3, kNear_rad = 0.1;  // no room repeats itself so closely: two halts on one way down
constexpr double kHopelessScore = 0.35;           // above the best score of the coarse poses
constexpr double kGoodScore = 0.3;                // most points within centimetres
constexpr double kShortReach_m = 0.12, kLongReach_m = 0.35;
constexpr std::size_t kMaxSettledWithPrior = 6;
constexpr std::size_t kMaxSettled = 28;  // an empty box has 24 places before gravity

bool same_place(const Candidate& a, const Candidate& b) {
  const Vec6 off = se3_log(a.state.T_room_lidar.inverse() * b.state.T_room_lidar);
  if (off.head<3>().norm() < kNear_m && off.tail<3>().norm() < kNear_rad) return true;
  return std::min(off.dot(a.information * off), off.dot(b.information * off)) < kOtherPlace;
}

}  // namespace

FitShares judge(std::span<const RayBlock> sample, const RefineInput& input, Candidate& candidate) {
  RangeSums sums;
  gather(input.surface, sample, input.sensor, candidate.state, {input.sigma_m, kTurnOver, 0, true}, sums);
  candidate.loss = mean_loss(sums);
  candidate.mapped_loss = sums.mapped == 0 ? candidate.loss : sums.loss / sums.mapped;
  const FitShares shares = shares_of(sums, input.sensor, input.sigma_m, candidate.state);
  const uint64_t mute = faces_without_evidence(sums);
  gather(input.surface, sample, input.sensor, candidate.state, {input.sigma_m, kTurnOver, mute, false}, sums);
  candidate.information = condense(sums, input.sensor, candidate.state).information;
  return shares;
}

void CandidateSet::insert(const Candidate& candidate) {
  auto* same = std::find_if(twins.begin(), twins.end(), [&](const Candidate& t) { return same_place(t, candidate); });
  if (same != twins.end()) {
    if (candidate.loss < same->loss) *same = candidate;
  } else if (!twins.push_back(candidate) && candidate.loss < twins.back().loss) {
    twins.back() = candidate;
  }
  std::sort(twins.begin(), twins.end(), [](const Candidate& a, const Candidate& b) { return a.loss < b.loss; });
}

void CandidateSet::drop_worse(double twin_loss) {
  if (twins.empty()) return;
  double best_mapped = twins[0].mapped_loss;
  for (const Candidate& twin : twins) best_mapped = std::min(best_mapped, twin.mapped_loss);
  const double best = twins[0].loss;
  std::size_t kept = 0;
  for (const Candidate& twin : twins) {
    const bool as_good = twin.loss <= best + twin_loss || twin.mapped_loss <= best_mapped + twin_loss;
    if (as_good) twins[kept++] = twin;
  }
  twins.truncate(kept);
}

void CandidateSet::settle_all(const Samples& samples, const RefineInput& input, const Hypotheses& hypotheses,
                              const AcceptanceLimits& accept, double twin_loss) {
  twins.clear();
  std::size_t settled = 0;
  Candidate refused;
  bool any_refused = false;
  const std::size_t most = input.prior == nullptr ? kMaxSettled : kMaxSettledWithPrior;
  for (const Hypothesis& hypothesis : hypotheses) {
    if (hypothesis.score > hypotheses[0].score + kHopelessScore || settled++ == most) break;
    Candidate candidate;
    candidate.state.T_room_lidar = hypothesis.T_room_lidar;
    settle(samples.coarse, input, hypothesis.score < kGoodScore ? kShortReach_m : kLongReach_m, candidate.state);
    const FitShares shares = judge(samples.fine, input, candidate);
    if (input.prior != nullptr && !within_prior(*input.prior, candidate.state.T_room_lidar)) continue;
    if (*why_refused(shares, accept) == '\0') {
      insert(candidate);
    } else if (!any_refused || candidate.loss < refused.loss) {
      refused = candidate;
      any_refused = true;
    }
  }
  drop_worse(twin_loss);
  if (twins.empty() && any_refused) insert(refused);  // to say why it is refused
}

}  // namespace roomcal::scan
