#include "runtime/grab/grabber.h"

#include <algorithm>

#include "runtime/base/reason.h"

namespace roomcal::grab {

namespace {

constexpr int64_t kPoll_ns = 2'000'000;

double to_ms(int64_t ns) { return static_cast<double>(ns) * 1e-6; }

Status aborted() { return {StatusCode::kCancelled, "aborted"}; }

}  // namespace

Status Grabber::fail(StatusCode code, const Reason& reason) {
  reason_ = reason;
  return {code, "no shot was taken"};
}

void Grabber::note(Grabbed& shot, const Reason& reason) {
  static_cast<void>(shot.notes.push_back(reason));  // beyond eight a person reads none
}

ports::Stillness Grabber::look() const {
  const int64_t now_ns = clocks_.now_ns();
  for (ports::StillnessSensor* sensor : sources_.stillness)
    if (const ports::Stillness seen = sensor->look(now_ns); !seen.still) return seen;
  return {true, {}};
}

Status Grabber::wait_still(GrabWatcher& watcher, int64_t deadline_ns) {
  int64_t since_ns = 0;
  for (bool was_still = false;;) {
    const ports::Stillness seen = look();
    const int64_t now_ns = clocks_.now_ns();
    if (seen.still && !was_still) since_ns = now_ns;
    was_still = seen.still;
    if (sources_.stillness.empty() || (was_still && now_ns - since_ns >= options_.still_for_ns)) return ok_status();
    if (now_ns >= deadline_ns) return fail(StatusCode::kUnavailable, seen.why);
    if (!watcher.waiting(GrabStep::kStillness, seen.why)) return aborted();
    clocks_.sleep_until(now_ns + kPoll_ns);
  }
}

Status Grabber::take_images(GrabWatcher& watcher, Grabbed& shot) {
  const int64_t begin_ns = clocks_.now_ns();
  if (sources_.trigger != nullptr) {
    if (const Status fired = sources_.trigger->fire(); !fired.ok())
      return fail(StatusCode::kNotFound, make_reason("trigger %s: %s", sources_.trigger->name(), fired.detail()));
  }
  std::size_t there = 0;
  shot.images.clear();
  for (HeldImage& image : shot.held) image = {};
  while (true) {
    there = 0;
    for (std::size_t i = 0; i < sources_.cameras.size(); ++i) {
      if (shot.held[i].luma.empty()) {
        const auto images = sources_.cameras[i].ring->hold_since(begin_ns);
        // The first after the trigger: those behind it belong to the next one.
        for (std::size_t k = 0; k + 1 < images.size(); ++k) sources_.cameras[i].ring->release(images[k]);
        if (!images.empty()) shot.held[i] = images.back();
      }
      there += shot.held[i].luma.empty() ? 0 : 1;
    }
    const int64_t now_ns = clocks_.now_ns();
    if (there == sources_.cameras.size() || now_ns - begin_ns >= options_.image_wait_ns) break;
    if (!watcher.waiting(GrabStep::kImages, "waiting for images")) return aborted();
    clocks_.sleep_until(now_ns + kPoll_ns);
  }
  for (std::size_t i = 0; i < sources_.cameras.size(); ++i) static_cast<void>(shot.images.push_back(shot.held[i].luma));
  if (there == 0 && !sources_.cameras.empty())
    return fail(StatusCode::kTooFew, "no camera delivers images: see `sensors` for each one's fault");
  return ok_status();
}

void Grabber::ask_sweeps() {
  for (const LidarFeed& lidar : sources_.lidars) lidar.tray->ask(lidar.sweeps);
}

bool Grabber::stop_sweeps() {
  bool quiet = true;
  for (const LidarFeed& lidar : sources_.lidars) quiet = lidar.tray->stop() && quiet;
  return quiet;
}

Status Grabber::wait_sweeps(GrabWatcher& watcher, Grabbed& shot) {
  const int64_t begin_ns = clocks_.now_ns();
  std::size_t most = 0;
  for (const LidarFeed& lidar : sources_.lidars) most = std::max(most, lidar.sweeps);
  const int64_t wait_ns = options_.sweep_wait_ns + static_cast<int64_t>(most) * options_.sweep_wait_ns / 4;
  while (true) {
    const int64_t now_ns = clocks_.now_ns();
    const bool all = std::all_of(sources_.lidars.begin(), sources_.lidars.end(),
                                 [](const LidarFeed& lidar) { return lidar.tray->full(); });
    if ((all && now_ns - begin_ns >= options_.dwell_ns) || now_ns - begin_ns >= std::max(wait_ns, options_.dwell_ns))
      break;
    if (!watcher.waiting(GrabStep::kSweeps, all ? "watching for motion" : "waiting for whole sweeps")) return aborted();
    clocks_.sleep_until(now_ns + kPoll_ns);
  }
  // A packet takes microseconds; a receiving thread that stands still for longer is the watchdog's business.
  while (!stop_sweeps()) clocks_.sleep_until(clocks_.now_ns() + kPoll_ns);
  shot.sweeps.clear();
  for (const LidarFeed& lidar : sources_.lidars) {
    const std::span<const lidar::Sweep> sweeps = lidar.tray->sweeps();
    static_cast<void>(shot.sweeps.push_back(sweeps));
    const Name who(lidar.name);
    if (sweeps.size() < lidar.sweeps)
      note(shot, make_reason("%.*s: %zu of %zu sweeps came whole, %u were discarded: see `sensors` for losses",
                             who.length, who.text, sweeps.size(), lidar.sweeps, lidar.tray->discarded()));
  }
  return ok_status();
}

bool Grabber::moved_between(Grabbed& shot) {
  std::size_t compared = 0;
  for (std::size_t i = 0; i < sources_.cameras.size(); ++i) {
    shot.motion[i] = compare_patches(before_[i], shot.images[i]);
    compared += shot.motion[i].compared;
    if (!has_moved(shot.motion[i], options_.motion)) continue;
    const Name who(sources_.cameras[i].name);
    reason_ = make_reason(
        "%.*s: its picture moved by %.2f px and changed in %zu of %zu places: keep the device still, "
        "step out of its view",
        who.length, who.text, shot.motion[i].median_px, shot.motion[i].changed, shot.motion[i].compared);
    return true;
  }
  if (compared > 0 || !sources_.stillness.empty()) return false;
  reason_ = "no camera sees enough to tell whether the device stands still: switch the light on, open the exposure";
  return true;
}

void Grabber::measure_spread(Grabbed& shot) {
  bool any = false;
  int64_t first_ns = 0, last_ns = 0;
  for (const HeldImage& image : shot.held) {
    if (image.luma.empty()) continue;
    first_ns = any ? std::min(first_ns, image.time.exposed_ns) : image.time.exposed_ns;
    last_ns = any ? std::max(last_ns, image.time.exposed_ns) : image.time.exposed_ns;
    shot.uncertainty_ns = std::max(shot.uncertainty_ns, image.time.uncertainty_ns);
    any = true;
  }
  shot.spread_ns = last_ns - first_ns;
}

Status Grabber::attempt(GrabWatcher& watcher, Grabbed& shot, bool& moved) {
  shot = Grabbed();
  shot.begin_ns = clocks_.now_ns();
  ROOMCAL_TRY(take_images(watcher, shot));
  for (std::size_t i = 0; i < shot.images.size(); ++i) take_patches(shot.images[i], before_[i]);
  release(shot);
  ask_sweeps();
  ROOMCAL_TRY(wait_sweeps(watcher, shot));
  ROOMCAL_TRY(take_images(watcher, shot));
  shot.end_ns = clocks_.now_ns();
  measure_spread(shot);
  const ports::Stillness now = look();
  moved = !now.still || moved_between(shot);
  if (!now.still) reason_ = now.why;
  return ok_status();
}

Status Grabber::grab(GrabWatcher& watcher, Grabbed& shot) {
  const int64_t deadline_ns = clocks_.now_ns() + options_.patience_ns;
  reason_.clear();
  for (std::size_t tries = 1;; ++tries) {
    ROOMCAL_TRY(wait_still(watcher, deadline_ns));
    bool moved = false;
    if (const Status taken = attempt(watcher, shot, moved); !taken.ok()) {
      while (!stop_sweeps()) clocks_.sleep_until(clocks_.now_ns() + kPoll_ns);
      release(shot);
      return taken;
    }
    shot.tries = tries;
    const bool apart = options_.max_spread_ns > 0 && shot.spread_ns > options_.max_spread_ns + 2 * shot.uncertainty_ns;
    if (!moved && !apart) break;
    if (!moved) {
      reason_ = make_reason("exposures lie %.1f ms apart, %.1f ms are allowed: check the trigger",
                            to_ms(shot.spread_ns), to_ms(options_.max_spread_ns));
    }
    release(shot);
    if (clocks_.now_ns() >= deadline_ns) return {StatusCode::kUnavailable, "the device did not stand still"};
    if (!watcher.waiting(GrabStep::kStillness, reason_)) return aborted();
  }
  reason_.clear();
  for (std::size_t i = 0; i < sources_.cameras.size(); ++i) {
    if (!shot.images[i].empty()) continue;
    const Name who(sources_.cameras[i].name);
    note(shot, make_reason("%.*s: no image came: see `sensors` for its fault", who.length, who.text));
  }
  return ok_status();
}

void Grabber::release(Grabbed& shot) {
  for (std::size_t i = 0; i < sources_.cameras.size(); ++i) {
    if (!shot.held[i].luma.empty()) sources_.cameras[i].ring->release(shot.held[i]);
    shot.held[i] = {};
  }
  shot.images.clear();
}

}  // namespace roomcal::grab
