#include "tools/join/join_shots.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <fmt/core.h>

#include "runtime/base/reason.h"
#include "runtime/calib/compare_installed.h"
#include "runtime/calib/map_errors.h"
#include "runtime/calib/quality_gate.h"
#include "runtime/calib/refine_jointly.h"
#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

template <typename T>
void keep(std::span<T>& span, std::vector<std::vector<T>>& storage) {
  storage.emplace_back(span.begin(), span.end());
  span = storage.back();
}

/// The shot whose sensor of this number is located with most evidence; the first shot if none has it.
template <typename Shots, typename Evidence>
std::size_t best_shot(const Shots& shots, const Evidence& evidence) {
  std::size_t best = 0;
  for (std::size_t s = 1; s < shots.size(); ++s)
    if (evidence(shots[s]->outcome) > evidence(shots[best]->outcome)) best = s;
  return best;
}

Mat66 block66(const Eigen::MatrixXd& cov, Eigen::Index first) { return cov.block<6, 6>(first, first); }

}  // namespace

void ShotJoiner::add(const std::string& name, const calib::Outcome& outcome) {
  auto kept = std::make_unique<Kept>();
  kept->name = name;
  kept->outcome = outcome;
  for (calib::CameraOutcome& camera : kept->outcome.cameras) {
    keep(camera.detections, kept->detections);
    keep(camera.inliers, kept->inliers);
    keep(camera.rings, kept->rings);
  }
  for (calib::LidarOutcome& lidar : kept->outcome.lidars) keep(lidar.pulls, kept->pulls);
  // The map's, the same in every shot that located anything.
  if (landmarks_.empty()) landmarks_.assign(outcome.landmarks.begin(), outcome.landmarks.end());
  if (plane_cov_.empty()) plane_cov_.assign(outcome.plane_cov.begin(), outcome.plane_cov.end());
  kept->outcome.landmarks = {};
  kept->outcome.plane_cov = {};
  kept->outcome.solution = {};
  shots_.push_back(std::move(kept));
}

std::size_t ShotJoiner::views_of(std::size_t camera) const {
  return static_cast<std::size_t>(
      std::count_if(shots_.begin(), shots_.end(), [&](const auto& s) { return s->outcome.cameras[camera].located; }));
}

std::size_t ShotJoiner::fullest_shot(std::size_t camera) const {
  return best_shot(shots_, [&](const calib::Outcome& outcome) {
    return outcome.cameras[camera].located ? 1 + outcome.cameras[camera].inliers.size() : 0;
  });
}

ShotJoiner::Views ShotJoiner::collect() const {
  Views views;
  std::vector<Sighting> lidars;
  const calib::Device& device = session_.device;
  std::size_t lens = 0;
  for (std::size_t s = 0; s < shots_.size(); ++s) {
    const calib::Outcome& outcome = shots_[s]->outcome;
    for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
      const calib::CameraOutcome& camera = outcome.cameras[i];
      if (!camera.located) continue;
      // One prior for n views of a lens: a share of it for each.
      const camera::Parameters sigma = device.intrinsics_sigma(i) * std::sqrt(static_cast<double>(views_of(i)));
      views.cameras.push_back({&device.cameras[i].camera, camera.rings, camera.T_room_cam, sigma});
      views.sightings.push_back({s, i, {}, sigma.isZero(0) ? kNone : lens++});
    }
    for (std::size_t i = 0; i < outcome.lidars.size(); ++i) {
      const calib::LidarOutcome& lidar = outcome.lidars[i];
      if (!lidar.located) continue;
      // The mounting counts once, not once a shot: it joins where shots are tied.
      views.lidars.push_back(
          {calib::believed(lidar.location), {}, scan::kUnseenSigma_m, scan::kUnseenSigma_rad, lidar.pulls});
      lidars.push_back({s, device.cameras.size() + i, {}, kNone});
    }
  }
  views.sightings.insert(views.sightings.end(), lidars.begin(), lidars.end());
  return views;
}

void ShotJoiner::solve_alone(const Views& views) {
  if (views.cameras.size() > rig::kMaxViews || views.lidars.size() > rig::kMaxLidars)
    throw ToolError(
        fmt::format("{} images and {} sweeps are too many for one problem, {} and {} is what it holds: "
                    "leave out some shots",
                    views.cameras.size(), views.lidars.size(), rig::kMaxViews, rig::kMaxLidars));
  std::size_t rings = 0, lenses = 0;
  for (const rig::CameraView& view : views.cameras) {
    rings += view.observations.size();
    lenses += view.intrinsics_sigma.isZero(0) ? 0 : 1;
  }
  const std::size_t sensors = views.sightings.size();
  step_bytes_.resize(rig::solve_step_bytes(sensors, lenses));
  std::vector<std::byte> scratch_bytes(
      rig::solve_scratch_bytes(sensors, rings, landmarks_.size(), lenses, views.lidars.size()));
  Arena step(step_bytes_), scratch(scratch_bytes);
  const rig::RigInput input{views.cameras, views.lidars, rig::kNoReference, landmarks_, plane_cov_};
  require(rig::solve_rig(input, calib::solve_options(session_), step, scratch, alone_), "joined shots");
}

TieInput ShotJoiner::tie_input(const Views& views) const {
  const calib::Device& device = session_.device;
  TieInput input;
  input.shots = shots_.size();
  input.units = device.cameras.size() + device.lidars.size();
  input.reference = device.reference;
  input.sightings = views.sightings;
  for (std::size_t k = 0; k < input.sightings.size(); ++k) input.sightings[k].T_room_sensor = alone_.T_room_sensor[k];
  for (const rig::RefinedLens& lens : alone_.lenses)
    input.lens.push_back(camera::parameters_of(lens.camera.intrinsics()));
  const auto size =
      static_cast<Eigen::Index>(6 * input.sightings.size() + camera::kIntrinsicsCount * input.lens.size());
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  input.cov = Eigen::Map<const RowMajor>(alone_.cov_room.data(), size, size);
  for (std::size_t i = 0; i < device.lidars.size(); ++i)
    if (const calib::NominalMounting& mounting = device.lidars[i].nominal; mounting.known)
      input.mounts.push_back(
          {device.cameras.size() + i, mounting.T_rig_sensor, mounting.sigma_t_m, mounting.sigma_rot_rad});
  return input;
}

void ShotJoiner::fill_camera(std::size_t i, std::size_t base, const TieSolution& tied) {
  calib::CameraOutcome& camera = joined_->cameras[i];
  camera = shots_[fullest_shot(i)]->outcome.cameras[i];
  camera.located = tied.known[i];
  camera.in_rig = camera.located && tied.known[joined_->reference];
  if (!camera.located) return;
  camera.failure = {};
  camera.T_rig_cam = tied.T_rig_unit[i];
  camera.T_room_cam = tied.T_room_rig[base] * tied.T_rig_unit[i];
  const auto row = static_cast<Eigen::Index>(6 * i);
  camera.cov_rig_cam = block66(tied.cov, row);
}

void ShotJoiner::fill_lidar(std::size_t i, std::size_t base, const TieSolution& tied) {
  const std::size_t unit = session_.device.cameras.size() + i;
  const std::size_t best = best_shot(shots_, [&](const calib::Outcome& outcome) {
    return outcome.lidars[i].located ? 8 - outcome.lidars[i].location.weak.size() : 0;
  });
  calib::LidarOutcome& lidar = joined_->lidars[i];
  lidar = shots_[best]->outcome.lidars[i];
  lidar.located = tied.known[unit];
  lidar.in_rig = lidar.located && tied.known[joined_->reference];
  if (!lidar.located) return;
  lidar.failure = {};
  const auto row = static_cast<Eigen::Index>(6 * unit);
  lidar.T_rig_lidar = tied.T_rig_unit[unit];
  lidar.cov_rig_lidar = block66(tied.cov, row);
  lidar.mount_took_part = session_.device.lidars[i].nominal.known && lidar.in_rig;
  lidar.T_room_lidar = tied.T_room_rig[base] * tied.T_rig_unit[unit];
  // Judged on what the shots tell themselves: the mounting carries what they leave open.
  lidar.location.weak = scan::find_weak_directions(block66(tied.cov_free, row).inverse(), lidar.T_room_lidar.R,
                                                   scan::ObservabilityLimits());
}

std::vector<ViewFit> ShotJoiner::fits(const Views& views) const {
  std::vector<ViewFit> fits;
  for (std::size_t k = 0; k < views.cameras.size(); ++k) {
    const Sighting& s = views.sightings[k];
    fits.push_back({views.cameras[k].observations.size(), s.shot == fullest_shot(s.unit)});
  }
  return fits;
}

std::size_t ShotJoiner::first_placed(const TieSolution& tied) const {
  const auto first = std::find(tied.placed.begin(), tied.placed.end(), true);
  return static_cast<std::size_t>(first - tied.placed.begin());
}

void ShotJoiner::fill(const TieInput& input, const TieSolution& tied, const std::vector<ViewFit>& fits) {
  const std::size_t base = first_placed(tied);
  joined_ = std::make_unique<calib::Outcome>(shots_[base]->outcome);
  for (std::size_t i = 0; i < joined_->cameras.size(); ++i) fill_camera(i, base, tied);
  for (std::size_t i = 0; i < joined_->lidars.size(); ++i) fill_lidar(i, base, tied);
  solution_.fill(session_.device, input, tied, base, alone_, fits, *joined_);
  for (calib::CameraOutcome& camera : joined_->cameras)
    if (camera.located) camera.rms_px = joined_->solution.rms_px[camera.view];
  for (std::size_t s = 0; s < shots_.size(); ++s) {
    const calib::Outcome& shot = shots_[s]->outcome;
    if (shot.held_out.median_sigmas > joined_->held_out.median_sigmas) joined_->held_out = shot.held_out;
    for (std::size_t stage = 0; stage < shot.stage_ns.size() && s != base; ++stage)
      joined_->stage_ns[stage] += shot.stage_ns[stage];
  }
}

void ShotJoiner::judge_joining(const TieInput& input, const TieSolution& tied) {
  const auto add = [&](calib::Verdict verdict, const Reason& reason) {
    joined_->verdict = std::max(joined_->verdict, verdict);
    static_cast<void>(joined_->reasons.push_back(reason));
  };
  for (std::size_t s = 0; s < shots_.size(); ++s) {
    const Kept& shot = *shots_[s];
    const int length = static_cast<int>(std::min<std::size_t>(shot.name.size(), 60));
    if (shot.outcome.verdict == calib::Verdict::kFailService)
      add(calib::Verdict::kFailService,
          make_reason("%.*s: is FAIL_SERVICE alone: mend what it says, or leave it out", length, shot.name.c_str()));
    else if (!tied.placed[s])
      add(calib::Verdict::kPassAdvise,
          make_reason("%.*s: takes no part, it locates no sensor that the others locate", length, shot.name.c_str()));
  }
  p_value_ = chi_square_tail(tied.chi2, tied.degrees_of_freedom);
  if (p_value_ >= session_.limits.moved_p_value) return;
  const std::size_t odd = odd_one_out(input, session_.limits.moved_p_value), cameras = session_.device.cameras.size();
  const std::string_view who = odd == kNone    ? std::string_view("device")
                               : odd < cameras ? session_.device.cameras[odd].name.view()
                                               : session_.device.lidars[odd - cameras].name.view();
  add(calib::Verdict::kFailService,
      make_reason(
          "%.*s: is not in the same place in all shots (p %.1g): tighten its bracket, then take all shots again",
          static_cast<int>(who.size()), who.data(), p_value_));
}

const calib::Outcome& ShotJoiner::join() {
  if (shots_.empty()) throw ToolError("no shots to join");
  const Views views = collect();
  if (views.sightings.empty()) {
    joined_ = std::make_unique<calib::Outcome>(shots_[0]->outcome);
    return *joined_;
  }
  solve_alone(views);
  const TieInput input = tie_input(views);
  const TieSolution tied = tie(input);
  fill(input, tied, fits(views));
  calib::compare_installed(session_, *joined_);
  calib::judge(session_.device, session_.limits, *joined_);
  judge_joining(input, tied);
  return *joined_;
}

}  // namespace roomcal::tools
