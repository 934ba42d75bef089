#include "runtime/scan/locate.h"

#include <algorithm>
#include <cmath>

#include "runtime/scan/by_prints.h"
#include "runtime/scan/locate_steps.h"
#include "runtime/scan/open_axis.h"

namespace roomcal::scan {

namespace {

constexpr double kOpenReach_m = 0.45;  // how far, without a prior's word
constexpr double kSuspicious = 0.003;  // share of points that nothing explains

/// What locate() keeps in scratch.
struct Workspace {
  Samples samples;
  std::span<float> residuals;
  CandidateSet* candidates = nullptr;
  AxisScratch axis;
  PrintMatcher matcher;

  static Status build(const SweepView& view, const SensorModel& sensor, Arena& scratch, Workspace& work) {
    ROOMCAL_TRY(Samples::take(view, sensor, scratch, work.samples));
    work.residuals = scratch.allocate<float>(Samples::kMaxRays);
    const std::span<CandidateSet> set = scratch.allocate<CandidateSet>(1);
    if (work.residuals.empty() || set.empty()) {
      return out_of_arena("scan: scratch arena too small, see locate_scratch_bytes()");
    }
    work.candidates = set.data();
    ROOMCAL_TRY(AxisScratch::build(scratch, work.axis));
    return PrintMatcher::build(scratch, work.matcher);
  }
};

void fill_beams(const RangeSums& sums, const SensorModel& sensor, const RangeState& state, Location& location) {
  const double sigma_m = sensor.beam_offset_sigma_m;
  location.beam_count = 0;
  for (std::size_t k = 0; k < kMaxBeams; ++k) {
    const RangeSums::Beam& beam = sums.beam[k];
    location.beam[k] = {state.offset_m[k], sigma_m, beam.points};
    if (beam.points == 0) continue;
    location.beam_count = k + 1;
    if (sigma_m <= 0) continue;
    const double pivot = beam.weight + 1 / (sigma_m * sigma_m);
    location.beam[k].sigma_m = std::sqrt(1 / pivot + beam.v.dot(location.cov * beam.v) / (pivot * pivot));
  }
}

/// A solution may be wrong along the axis that its points fix least, where that is open, or where some of them are not
/// explained.
void look_along_weakest_axis(const SweepView& view, const AxisScratch& scratch, RefineInput& input,
                             FineSolution& fine) {
  const Mat66 information = condense(fine.sums, input.sensor, fine.linearized_at).information;
  const OpenAxis open = open_axis_of(information, fine.state.T_room_lidar.R, input.prior, kOpenReach_m);
  const auto unexplained = static_cast<double>(fine.sums.valid - fine.sums.inliers);
  if (open.open || unexplained > kSuspicious * fine.sums.valid) search_axis(view, open, scratch, fine, input);
}

void fill_location(const RefineInput& input, const FineSolution& fine, const PrintMeasurement& prints,
                   const LocateOptions& options, Location& location) {
  const RangeState& state = fine.state;
  fill_counts(fine.sums, input.sensor, input.sigma_m, state, location);
  location.T_room_lidar = state.T_room_lidar;
  location.information = condense(fine.sums, input.sensor, fine.linearized_at);
  location.information.information += prints.weight * prints.J * prints.J.transpose();
  location.weak = find_weak_directions(location.information.information, state.T_room_lidar.R, options.observe);
  Mat66 with_prior = location.information.information;
  Vec6 unused = Vec6::Zero();
  if (input.prior != nullptr) add_prior(*input.prior, state.T_room_lidar, with_prior, unused);
  location.cov = covariance_of(with_prior);
  location.print_points = prints.points;
  fill_beams(fine.sums, input.sensor, state, location);
}

}  // namespace

const char* to_string(LocateOutcome outcome) {
  switch (outcome) {
    case LocateOutcome::kLocated:
      return "located";
    case LocateOutcome::kAmbiguous:
      return "ambiguous";
    case LocateOutcome::kRefused:
      return "refused";
  }
  return "";
}

std::size_t locate_scratch_bytes() {
  return Samples::bytes() + Samples::kMaxRays * sizeof(float) + sizeof(CandidateSet) + AxisScratch::bytes() +
         PrintMatcher::bytes() + 256;
}

Status locate(const Surface& surface, std::span<const lidar::Sweep> sweeps, const SensorModel& sensor,
              const PosePrior* prior, const LocateOptions& options, Arena& scratch, Location& location) {
  location = {};
  ROOMCAL_TRY(check_inputs(sweeps, sensor, prior));
  const Arena::Scope scope(scratch);
  const SweepView view{sweeps};
  Workspace work;
  ROOMCAL_TRY(Workspace::build(view, sensor, scratch, work));
  if (ray_count(work.samples.fine) < options.accept.min_points) {
    refuse(location, kTooFewPoints);
    return ok_status();
  }
  RefineInput input{surface, sensor, prior, sensor.sigma_m, 0};
  CandidateSet& candidates = *work.candidates;
  Hypotheses hypotheses;
  find_places(work.samples, input, options, candidates, hypotheses);
  if (candidates.twins.empty()) {
    refuse(location, kNoPlace);
    return ok_status();
  }
  // Without a prior a lone place is asked as well: its better twin may have been lost on the way.
  const bool ask_prints = options.use_reflectivity && (prior == nullptr || candidates.twins.size() > 1);
  const bool confirmed = !ask_prints || tell_twins_apart(view, input, work.matcher, candidates);
  FineSolution fine;
  fine.state = candidates.twins[0].state;
  input.sigma_m = spread_m(work.samples.fine, input, fine.state, work.residuals);
  refine(view, input, fine);
  look_along_weakest_axis(view, work.axis, input, fine);
  // Only within a prior's reach: over a metre, a wrong place has been seen to match (one of nine real and simulated
  // sets).
  PrintMeasurement prints;
  if (options.use_reflectivity && fine.converged && prior != nullptr) {
    prints = close_axis(view, work.matcher, input, fine);
  }
  location.twins = static_cast<int>(candidates.twins.size());
  if (!confirmed && prior == nullptr) location.twins = std::max(2, location.twins);
  location.azimuth = azimuth_coverage(work.samples.fine, input, fine.state);
  fill_location(input, fine, prints, options, location);
  conclude(fine.converged, options.accept, location);
  return ok_status();
}

}  // namespace roomcal::scan
