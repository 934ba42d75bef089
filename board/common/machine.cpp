#include "board/common/machine.h"

#include <algorithm>
#include <cstring>

#include <sys/mman.h>

#include "board/common/stack.h"
#include "runtime/base/reason.h"
#include "runtime/calib/lidar_models.h"
#include "runtime/profile/driver_check.h"

namespace roomcal::board {

namespace {

constexpr int kSensorPriority = 20;  // above what computes, so that a long detection loses no packet
constexpr std::size_t kPressThread = calib::kMaxCameras, kLidarThread = calib::kMaxCameras + 1;

}  // namespace

Machine::Machine(const MachineOptions& options, const drivers::LinuxClocks& clocks, EventLog& log, CanSide& can)
    : options_(options), clocks_(clocks), log_(log), can_(can) {}

Machine::~Machine() { disarm(); }

Status Machine::fail(Status status, std::string_view part, Reason& why) {
  why = make_reason("%.*s: %s", static_cast<int>(part.size()), part.data(), status.detail());
  return status;
}

Status Machine::plan(Reason& why) {
  ROOMCAL_TRY(load_files(options_.folder, files_, why));
  const profile::Profile& profile = *files_.profile;
  ROOMCAL_TRY(profile::check_drivers(profile, why));
  if (const Status made = to_device(profile, device_); !made.ok()) return fail(made, "profile", why);
  if (!profile.wiring.replay_folder.empty()) {
    const std::string shots = options_.folder.below(profile.wiring.replay_folder.view());
    if (const Status opened = replay_.open(std::string_view(shots), clocks_.now_ns()); !opened.ok())
      return fail(opened, shots, why);
  }
  return plan_board(*options_.board, profile, device_, files_.map, files_.map_bytes, replay_, plan_, why);
}

Status Machine::reserve(Reason& why) {
  if (const Status reserved = memory_.reserve(plan_.total_bytes()); !reserved.ok())
    return fail(reserved, "memory", why);
  if (!memory_.lock_status().ok()) log_.note("memory", memory_.lock_status().detail());
  arena_ = Arena(memory_.bytes().first(std::min(memory_.bytes().size(), options_.starve_bytes)));
  return ok_status();
}

// Before everything else: it may be all that works, and what is in force is wanted by others at once.
Status Machine::open_store(Reason& why) {
  const profile::StoreWiring& w = files_.profile->wiring.store;
  const std::string path = options_.folder.below(w.path.empty() ? "store" : w.path.view());
  drivers::MediumOptions options;
  options.kind = static_cast<drivers::MediumKind>(w.kind);
  options.path = path.c_str();
  options.size_bytes = w.size_bytes;
  options.page_bytes = w.page_bytes;
  if (const Status opened = medium_.open(options); !opened.ok()) {
    why = make_reason("store: %s: %s%s%s", path.c_str(), opened.detail(), medium_.error_number() != 0 ? ": " : "",
                      medium_.error_number() != 0 ? std::strerror(medium_.error_number()) : "");
    return opened;
  }
  if (const Status opened = store_.open(medium_, arena_, files_.profile->serial); !opened.ok())
    return fail(opened, "store", why);
  store_open_ = true;
  const bool blank =
      store_.conditions()[static_cast<std::size_t>(store::Slot::kFactory)] == store::SlotCondition::kEmpty;
  if (blank && files_.factory != nullptr) {
    const Status provisioned = store_.provision(*files_.factory, clocks_.read(ClockId::kRealtime).ns / 1'000'000'000);
    log_.note("store", provisioned.ok() ? "factory record written" : provisioned.detail());
  }
  if (const Reason diagnosis = store_.diagnosis(); !diagnosis.empty()) log_.note("store", diagnosis.view());
  log_.note("store", to_string(store_.state()));
  return ok_status();
}

Status Machine::place_map(Reason& why) {
  const std::span<uint64_t> words = arena_.allocate_uninitialized<uint64_t>(files_.map_words.size());
  if (words.empty()) return fail(out_of_arena("no memory for the map"), "map", why);
  std::copy(files_.map_words.begin(), files_.map_words.end(), words.begin());
  map_file_ = std::as_bytes(words).first(files_.map_bytes);
  Result<map::RoomMap> opened = map::RoomMap::open(map_file_);
  if (!opened.ok()) return fail(opened.status(), "map", why);
  map_ = opened.value();
  return ok_status();
}

Status Machine::open_cameras(Reason& why) {
  const profile::Profile& profile = *files_.profile;
  const ImageDriverParts parts{clocks_, log_, v4l2_, replay_};
  for (std::size_t i = 0; i < profile.cameras.size(); ++i) {
    const profile::CameraProfile& camera = profile.cameras[i];
    const std::string_view name = camera.name.view();
    if (const Status made = rings_[i].create(camera.intrinsics.width_px, camera.intrinsics.height_px,
                                             options_.board->image_slots, arena_);
        !made.ok())
      return fail(made, name, why);
    const std::size_t recorded = ImageDriver::memory_bytes(camera, replay_);
    const std::span<std::byte> memory = std::as_writable_bytes(
        arena_.allocate_uninitialized<std::max_align_t>(recorded / sizeof(std::max_align_t) + 1));
    if (memory.empty()) return fail(out_of_arena("no memory for its recordings"), name, why);
    if (const Status chosen = image_drivers_[i].choose(camera, profile.wiring.trigger, parts, memory); !chosen.ok())
      return fail(chosen, name, why);
    const Status started = image_drivers_[i].source().start();
    if (started.code() == StatusCode::kUnsupported || started.code() == StatusCode::kOutOfMemory)
      return fail(started, name, why);
    if (!started.ok()) log_.note(name, started.detail());  // the driver goes on looking for it
    static_cast<void>(sources_.cameras.push_back({camera.name, &rings_[i]}));
    face::CameraVitals vitals;
    vitals.name = camera.name;
    vitals.driver = to_string(camera.wiring.driver);
    vitals.key = camera.wiring.key;
    vitals.width_px = camera.intrinsics.width_px;
    vitals.height_px = camera.intrinsics.height_px;
    camera_threads_[i].prepare(vitals, image_drivers_[i].source(), rings_[i], clocks_);
  }
  return ok_status();
}

Status Machine::open_lidars(Reason& why) {
  lidar_thread_.prepare(clocks_);
  std::size_t on_turntables = 0;
  for (std::size_t i = 0; i < files_.profile->lidars.size(); ++i) {
    on_turntables += files_.profile->lidars[i].on_turntable ? 1 : 0;
    ROOMCAL_TRY(open_lidar(i, why));
  }
  if (on_turntables > 1) return fail({StatusCode::kUnsupported, "one servo turns one profiler"}, "turntable", why);
  if (on_turntables == 1) can_.turn_for(turntable_);
  return ok_status();
}

Status Machine::open_lidar(std::size_t i, Reason& why) {
  const profile::LidarProfile& lidar = files_.profile->lidars[i];
  const std::string_view name = lidar.name.view();
  const lidar::SweepOptions cut = sweep_options(*options_.board, lidar);
  const Status made = lidar.on_turntable ? turntable_.create(lidar.calibration, cut,
                                                             turntable_options(*options_.board, lidar), clocks_, arena_)
                                         : trays_[i].create(lidar.calibration, cut, lidar.wiring.sweeps, arena_);
  if (!made.ok()) return fail(made, name, why);
  const std::span<std::byte> memory = std::as_writable_bytes(arena_.allocate_uninitialized<std::max_align_t>(
      PacketDriver::memory_bytes(lidar, replay_) / sizeof(std::max_align_t) + 1));
  if (memory.empty()) return fail(out_of_arena("no memory for its packets"), name, why);
  packet_drivers_[i].choose(lidar, replay_, clocks_, memory);
  const Status started = packet_drivers_[i].source().start();
  if (started.code() == StatusCode::kNotFound)
    log_.note(name, started.detail());  // the driver goes on looking for it
  else if (!started.ok())
    return fail(started, name, why);
  face::LidarVitals vitals;
  vitals.name = lidar.name;
  vitals.model = lidar.model;
  vitals.driver = to_string(lidar.wiring.driver);
  const std::string_view sender = lidar.wiring.sender.view();
  vitals.address = make_reason("%.*s:%u", static_cast<int>(sender.size()), sender.data(), lidar.wiring.port).view();
  vitals.connected = started.ok();
  if (lidar.on_turntable) {
    static_cast<void>(sources_.lidars.push_back({lidar.name, &turntable_, 1}));
    lidar_thread_.add(vitals, packet_drivers_[i], turntable_, turntable_.counters());
  } else {
    static_cast<void>(sources_.lidars.push_back({lidar.name, &trays_[i], lidar.wiring.sweeps}));
    lidar_thread_.add(vitals, packet_drivers_[i], trays_[i], trays_[i].counters());
  }
  return ok_status();
}

void Machine::open_thermometer() {
  const profile::PathText& path = files_.profile->wiring.thermometer.path;
  if (path.empty()) return;
  thermometer_.emplace(std::string_view(options_.folder.below(path.view())), files_kernel_);
  if (const Status started = thermometer_->start(); !started.ok()) log_.note("thermometer", started.detail());
}

grab::GrabOptions Machine::grab_options() const {
  const profile::GrabWiring& w = files_.profile->grab;
  grab::GrabOptions options;
  options.patience_ns = static_cast<int64_t>(w.patience_s * 1e9);
  options.image_wait_ns = static_cast<int64_t>(w.image_wait_s * 1e9);
  options.max_spread_ns = static_cast<int64_t>(w.max_spread_ms * 1e6);
  options.motion.median_px = w.still_px;
  constexpr double kSpinUp_s = 5;
  if (files_.profile->wiring.servo.node != 0)
    options.sweep_wait_ns = static_cast<int64_t>((1.5 * files_.profile->wiring.servo.half_turn_s + kSpinUp_s) * 1e9);
  return options;
}

Status Machine::make_session(Reason& why) {
  const calib::MemoryPlan& p = plan_.session;
  session_block_ = std::as_writable_bytes(
      arena_.allocate_uninitialized<std::max_align_t>(p.total_bytes() / sizeof(std::max_align_t) + 1));
  if (session_block_.empty()) return fail(out_of_arena("no memory for it"), "session", why);
  Result<Arenas> carved = Arenas::carve(session_block_, p.permanent_bytes, p.scratch_bytes);
  if (!carved.ok()) return fail(carved.status(), "session", why);
  arenas_.emplace(std::move(carved).value());
  Result<map::TriangleIndex> index = map::TriangleIndex::build(map_, arenas_->permanent);
  if (!index.ok()) return fail(index.status(), "map", why);
  index_ = index.value();
  if (!device_.lidars.empty()) {
    Result<scan::Surface> surface = scan::Surface::build(map_, {}, arenas_->permanent, arenas_->scratch);
    if (!surface.ok()) return fail(surface.status(), "map", why);
    surface_ = surface.value();
  }
  arenas_->permanent.seal();
  if (files_.profile->wiring.can.standstill) static_cast<void>(sources_.stillness.push_back(&can_.stillness()));
  session_.emplace(calib::Session{.device = device_,
                                  .map = map_,
                                  .index = index_,
                                  .limits = files_.profile->limits,
                                  .surface = device_.lidars.empty() ? nullptr : &surface_});
  grabber_.emplace(sources_, grab_options(), clocks_);
  press_.emplace(press::Parts{*session_, *grabber_, store_, *arenas_, clocks_, kFirmware, files_.profile->serial,
                              &press_thread_.link.pulse.last(), thermometer_ ? &*thermometer_ : nullptr,
                              synchronization_});
  look_.emplace(device_, session_->limits, sources_, *arenas_, clocks_);
  press_thread_.prepare(*press_, *look_, clocks_);
  return ok_status();
}

Status Machine::start_threads(Reason& why) {
  const auto start = [&](std::size_t i, std::string_view name, drivers::Thread::Body& body, ThreadLink& link,
                         std::size_t stack, int priority) {
    const std::span<std::byte> memory = take_stack(stack, arena_);
    if (memory.empty()) return fail(out_of_arena("no memory for its thread's stack"), name, why);
    drivers::ThreadOptions options;
    options.name = name;
    options.fifo_priority = priority;
    link.pulse.beat(clocks_.now_ns());
    if (const Status started = threads_[i].start(options, body, memory); !started.ok()) return fail(started, name, why);
    static_cast<void>(links_.push_back(&link));
    return ok_status();
  };
  for (std::size_t i = 0; i < device_.cameras.size(); ++i)
    ROOMCAL_TRY(start(i, device_.cameras[i].name.view(), camera_threads_[i], camera_threads_[i].link,
                      options_.board->camera_stack, kSensorPriority));
  if (!device_.lidars.empty())
    ROOMCAL_TRY(
        start(kLidarThread, "lidars", lidar_thread_, lidar_thread_.link, options_.board->lidar_stack, kSensorPriority));
  return start(kPressThread, "session", press_thread_, press_thread_.link, options_.board->press_stack, 0);
}

Status Machine::arm(Reason& why) {
  ROOMCAL_TRY(reserve(why));
  ROOMCAL_TRY(open_store(why));
  ROOMCAL_TRY(place_map(why));
  ROOMCAL_TRY(settle_trigger(why));
  ROOMCAL_TRY(open_cameras(why));
  ROOMCAL_TRY(gather_software_trigger(why));
  ROOMCAL_TRY(open_lidars(why));
  open_thermometer();
  ROOMCAL_TRY(make_session(why));
  ROOMCAL_TRY(start_threads(why));
  arena_.seal();
  files_.map_words = {};
  files_.factory.reset();
  // Code, data and libraries too: what was never touched yet must not be fetched in the middle of a press.
  if (::mlockall(MCL_CURRENT) != 0) log_.note("memory", "code is not locked: raise LimitMEMLOCK in the service's unit");
  armed_ns_ = clocks_.now_ns();
  armed_ = true;
  for (ThreadLink* link : links_) link->armed.store(true, std::memory_order_release);
  return ok_status();
}

void Machine::disarm() {
  if (press_) press_->abort();
  for (ThreadLink* link : links_) link->stop.store(true, std::memory_order_release);
  for (drivers::Thread& thread : threads_) thread.join();
  links_.clear();
  for (std::size_t i = 0; i < sources_.cameras.size(); ++i) image_drivers_[i].source().stop();
  for (std::size_t i = 0; i < sources_.lidars.size(); ++i) packet_drivers_[i].source().stop();
  sources_.cameras.clear();
  sources_.lidars.clear();
  sources_.trigger = nullptr;
  armed_ = false;
}

void Machine::advance_replay() {
  if (replay_.shots() > 0) replay_.advance(clocks_.now_ns());
}

int64_t Machine::longest_silence_ns(int64_t now_ns) const {
  int64_t longest_ns = 0;
  for (const ThreadLink* link : links_) longest_ns = std::max(longest_ns, now_ns - link->pulse.last_ns());
  return longest_ns;
}

}  // namespace roomcal::board
