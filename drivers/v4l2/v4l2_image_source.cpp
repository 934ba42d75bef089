#include "drivers/v4l2/v4l2_image_source.h"

#include <algorithm>
#include <limits>

#include "drivers/image/start_status.h"

namespace roomcal::drivers {

using ports::ImageFacts;
using ports::ImageFault;
using ports::SourceState;

namespace {

constexpr int64_t kMillisecondNs = 1'000'000, kSecondNs = 1'000'000'000;

RecoveryOptions ladder_for(const V4l2Options& options) {
  RecoveryOptions ladder;
  ladder.may_reset_port = options.may_reset_port;
  // To look for a camera is to read a folder: whoever plugs it in again does not wait for half a minute.
  ladder.longest_wait_ns = 4 * kSecondNs;
  constexpr int64_t kTriggeredNs = 2 * kSecondNs;  // also whoever fires takes his time
  constexpr double kPeriods = 5;
  if (options.trigger == TriggerMode::kExternal) ladder.stall_ns = kTriggeredNs;
  if (options.fps > 0) ladder.stall_ns = std::max(ladder.stall_ns, static_cast<int64_t>(kPeriods * 1e9 / options.fps));
  return ladder;
}

Status check(const V4l2Options& options) {
  constexpr int kMostPixels = 16384, kLongestExposureUs = 10'000'000;
  constexpr double kSlowest = 0.1, kFastest = 1000;
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!within(options.width_px, 2, kMostPixels) || !within(options.height_px, 2, kMostPixels))
    return {StatusCode::kUnsupported, "the profile's image size is none that a camera has"};
  if (options.formats.empty()) return {StatusCode::kUnsupported, "the profile names no pixel format for the camera"};
  if (options.fps != 0 && !within(options.fps, kSlowest, kFastest))
    return {StatusCode::kUnsupported, "the profile's image rate is not 0 or 0.1 to 1000 a second"};
  if (options.exposure_us > kLongestExposureUs)
    return {StatusCode::kUnsupported, "the profile's exposure is longer than 10 s"};
  const Status key = CameraKey::check(options.key.view());
  return key.ok() ? key : Status{StatusCode::kUnsupported, key.detail()};
}

}  // namespace

V4l2ImageSource::V4l2ImageSource(std::string_view name, const V4l2Options& options, V4l2Kernel& kernel,
                                 const ports::SystemClocks& clocks, ports::Log& log)
    : options_(options),
      clocks_(clocks),
      log_(name, log),
      recovery_(ladder_for(options)),
      device_(kernel, options_, log_) {}

Status V4l2ImageSource::start() {
  stop();
  log_.start();
  recovery_.start(clocks_.now_ns());
  if (const Status prepared = prepare(); !prepared.ok()) {
    log_.note(prepared.detail());
    fault(ImageFault::kFormat);
    return prepared;
  }
  open();
  return start_status(device_.is_open() ? ImageFault::kCount : log_.health().last_fault);
}

// What the profile asks for, as far as it can be known without the camera.
Status V4l2ImageSource::prepare() {
  ROOMCAL_TRY(check(options_));
  const bool mjpeg =
      std::find(options_.formats.begin(), options_.formats.end(), PixelFormat::kMjpeg) != options_.formats.end();
  if (!mjpeg || !MjpegDecoder::kBuiltIn || !mjpeg_memory_.bytes().empty()) return ok_status();
  ROOMCAL_TRY(mjpeg_memory_.reserve(MjpegDecoder::memory_bytes(options_.width_px)));
  return mjpeg_.open(mjpeg_memory_.bytes());
}

void V4l2ImageSource::stop() {
  device_.close();
  recovery_.stop();
  log_.state(SourceState::kClosed);
}

Status V4l2ImageSource::next(int64_t wait_ns, MutableImageView into, ImageFacts& facts) {
  if (into.width() != options_.width_px || into.height() != options_.height_px)
    return {StatusCode::kInvalidArgument, "the image to fill is not of the profile's size"};
  if (recovery_.state() == SourceState::kClosed) return {StatusCode::kUnavailable, "the camera is not started"};
  const int64_t began_ns = clocks_.now_ns();
  const int64_t deadline_ns = began_ns + std::clamp<int64_t>(wait_ns, 0, std::numeric_limits<int64_t>::max() / 4);
  recovery_.resume(began_ns);
  bool got = false;
  do {
    got = step(deadline_ns, into, facts);
  } while (!got && clocks_.now_ns() < deadline_ns);
  recovery_.pause(clocks_.now_ns());
  log_.state(recovery_.state());
  return got ? ok_status() : Status{StatusCode::kUnavailable, "no image came in that time"};
}

bool V4l2ImageSource::step(int64_t deadline_ns, MutableImageView into, ImageFacts& facts) {
  const RecoveryOrder order = recovery_.order(clocks_.now_ns());
  switch (order.step) {
    case RecoveryStep::kWatch:
      return watch(std::min(order.until_ns, deadline_ns), into, facts);
    case RecoveryStep::kRestartStream: {
      log_.step(order.step);
      const Trouble trouble = device_.restart();
      if (trouble.none()) stream_began();
      report(trouble);
      break;
    }
    case RecoveryStep::kReopen:
      open();
      if (device_.is_open() || !is_absence(log_.health().last_fault)) log_.step(order.step);
      break;
    case RecoveryStep::kResetPort: {
      log_.step(order.step);
      const Trouble trouble = device_.reset_port();
      if (trouble.none()) recovery_.port_reset(clocks_.now_ns());
      report(trouble);
      break;
    }
    case RecoveryStep::kGiveUp:
      log_.step(order.step);
      [[fallthrough]];
    case RecoveryStep::kStayClosed:
      device_.close();
      clocks_.sleep_until(std::min(order.until_ns, deadline_ns));
  }
  return false;
}

void V4l2ImageSource::open() {
  const Trouble trouble = device_.open();
  if (trouble.none()) stream_began();
  report(trouble);
}

void V4l2ImageSource::stream_began() {
  const CaptureFormat& format = device_.format();
  const int64_t now_ns = clocks_.now_ns();
  judge_.begin(luma_bytes(format.format, format.width_px, format.height_px, format.stride_bytes), device_.timing(),
               now_ns);
  recovery_.begun(now_ns);
}

bool V4l2ImageSource::watch(int64_t until_ns, MutableImageView into, ImageFacts& facts) {
  if (drain(into, facts)) return true;
  if (!device_.is_open() || recovery_.order(clocks_.now_ns()).step != RecoveryStep::kWatch) return false;
  bool ready = false;
  const int64_t now_ns = clocks_.now_ns();
  const Trouble trouble = device_.wait(std::max<int64_t>(until_ns - now_ns, 0), ready);
  const bool got = ready && drain(into, facts);
  report(trouble);
  if (got) return true;
  if (recovery_.stalled(clocks_.now_ns())) fault(ImageFault::kStall);
  // Ready, and yet nothing there: some drivers do that, and must not make us spin.
  if (ready) clocks_.sleep_until(clocks_.now_ns() + kMillisecondNs);
  return false;
}

// Takes all that has come, hands over the newest of it.
bool V4l2ImageSource::drain(MutableImageView into, ImageFacts& facts) {
  FilledBuffer newest;
  ImageFacts its_facts;
  bool any = false;
  const Trouble taking = take_newest(newest, its_facts, any);
  // The image is copied before anything is done about trouble: that may unmap it.
  const bool got = any && hand_over(newest, its_facts, into);
  if (got) facts = its_facts;
  const Trouble putting_back = any && taking.fault != ImageFault::kGone ? device_.queue(newest.index) : Trouble{};
  report(taking);
  if (taking.none()) report(putting_back);
  return got;
}

Trouble V4l2ImageSource::take_newest(FilledBuffer& newest, ImageFacts& facts, bool& any) {
  constexpr int kMostAtOnce = 2 * BufferRing::kMost;  // a camera faster than our copying must not hold us for ever
  for (int i = 0; i < kMostAtOnce; ++i) {
    const int64_t now_ns = clocks_.now_ns();
    FilledBuffer filled;
    bool more = false;
    ROOMCAL_TRY_CALL(device_.dequeue(more, filled));
    if (!more) {
      judge_.seen_empty(now_ns);
      return {};
    }
    const Judgement judgement = judge_.judge(filled, clocks_.now_ns());
    if (judgement.fault != ImageFault::kCount) fault(judgement.fault);
    if (judgement.backlog || (judgement.keep && any)) log_.superseded();
    uint32_t unused = filled.index;
    if (judgement.keep) {
      unused = newest.index;
      newest = filled;
      facts = judgement.facts;
    }
    const bool put_back = !judgement.keep || any;
    any = any || judgement.keep;
    if (put_back) ROOMCAL_TRY_CALL(device_.queue(unused));
  }
  return {};
}

bool V4l2ImageSource::hand_over(const FilledBuffer& image, const ImageFacts& facts, MutableImageView into) {
  if (!copy(image, into).ok()) {
    fault(ImageFault::kUndecodable);
    return false;
  }
  judge_.told();
  recovery_.image(facts.arrived_ns);
  log_.image(facts.lost_before, facts.arrived_ns);
  return true;
}

Status V4l2ImageSource::copy(const FilledBuffer& image, MutableImageView into) {
  const CaptureFormat& format = device_.format();
  if (format.format == PixelFormat::kMjpeg) return mjpeg_.decode(image.bytes, into);
  return to_luma({format.format, format.width_px, format.height_px, format.stride_bytes, image.bytes}, into);
}

void V4l2ImageSource::report(const Trouble& trouble) {
  if (trouble.none()) return;
  fault(trouble.fault, trouble.error_number);
  if (trouble.fault == ImageFault::kGone) device_.abandon();
}

void V4l2ImageSource::fault(ImageFault fault, int error_number) {
  const int64_t now_ns = clocks_.now_ns();
  log_.fault(fault, now_ns, error_number);
  // A camera that has streamed as asked since start() can do it: that it now refuses is a matter of its state.
  const bool refuses_now = fault == ImageFault::kFormat && log_.health().images > 0;
  recovery_.fault(refuses_now ? ImageFault::kStale : fault, now_ns);
  log_.state(recovery_.state());
}

}  // namespace roomcal::drivers
