#include "drivers/replay/replay_image_source.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "drivers/replay/file.h"
#include "drivers/replay/pgm.h"

namespace roomcal::drivers {

using ports::ImageFault;
using ports::SourceState;

namespace {

constexpr int64_t kRetry_ns = 1'000'000'000;

std::size_t image_bytes(const ReplayImageOptions& options) {
  if (options.width_px <= 0 || options.height_px <= 0) return 0;
  return static_cast<std::size_t>(options.width_px) * static_cast<std::size_t>(options.height_px);
}

}  // namespace

std::size_t ReplayImageSource::memory_bytes(const ReplayImageOptions& options, int shots) {
  return image_bytes(options) * static_cast<std::size_t>(std::max(shots, 0));
}

std::span<std::byte> ReplayImageSource::pixels(int shot) const {
  const std::size_t size = image_bytes(options_);
  return memory_.subspan(static_cast<std::size_t>(shot) * size, size);
}

Status ReplayImageSource::fail(ImageFault fault, Status status) {
  health_.fault(fault, clocks_.now_ns());
  health_.state(status.code() == StatusCode::kNotFound ? SourceState::kRecovering : SourceState::kFaulted);
  return status;
}

Status ReplayImageSource::load_shot(int shot) {
  const InputFile file(cursor_.path(shot, name(), ".pgm").data());
  if (!file.found())
    return fail(ImageFault::kNotFound, {StatusCode::kNotFound, "a shot of the replay folder has no .pgm of its name"});
  std::array<std::byte, kMaxPgmHead> beginning{};
  const std::span<std::byte> head_bytes = std::span(beginning).first(std::min(beginning.size(), file.size()));
  static_cast<void>(file.read(0, head_bytes));
  const Result<PgmHead> head = read_pgm_head(head_bytes);
  if (!head.ok()) return fail(ImageFault::kFormat, {StatusCode::kUnsupported, head.status().detail()});
  if (head.value().width_px != options_.width_px || head.value().height_px != options_.height_px)
    return fail(ImageFault::kFormat, {StatusCode::kUnsupported, "its image has another size than the profile says"});
  if (!file.read(head.value().pixels_at, pixels(shot)))
    return fail(ImageFault::kShort, {StatusCode::kUnsupported, "its image file ends before its last pixel"});
  return ok_status();
}

Status ReplayImageSource::load() {
  for (int shot = 0; shot < cursor_.shots(); ++shot) ROOMCAL_TRY(load_shot(shot));
  loaded_ = true;
  health_.state(SourceState::kStreaming);
  return ok_status();
}

Status ReplayImageSource::start() {
  stop();
  health_.start();
  if (image_bytes(options_) == 0 || options_.period_ns <= 0)
    return fail(ImageFault::kFormat, {StatusCode::kUnsupported, "a replayed camera needs a size and a rate"});
  if (memory_.size() < memory_bytes(options_, cursor_.shots()))
    return fail(ImageFault::kNoMemory, {StatusCode::kOutOfMemory, "more shots to replay than the board has room for"});
  retry_at_ns_ = clocks_.now_ns() + kRetry_ns;
  return load();
}

void ReplayImageSource::stop() {
  loaded_ = false;
  retry_at_ns_ = 0;
  last_tick_ = -1;
  sequence_ = 0;
  health_.state(SourceState::kClosed);
}

/// A missing image may still be put there.
Status ReplayImageSource::retry(int64_t deadline_ns) {
  const bool hopeful = health().state == SourceState::kRecovering;
  if (!hopeful || retry_at_ns_ > deadline_ns) {
    clocks_.sleep_until(deadline_ns);
    return {StatusCode::kUnavailable, "the replayed camera has no images"};
  }
  clocks_.sleep_until(retry_at_ns_);
  retry_at_ns_ += kRetry_ns;
  return load();
}

void ReplayImageSource::copy(int shot, MutableImageView into) const {
  const std::byte* row = pixels(shot).data();
  const auto width = static_cast<std::size_t>(options_.width_px);
  for (int y = 0; y < options_.height_px; ++y, row += width) std::memcpy(into.row(y), row, width);
}

Status ReplayImageSource::next(int64_t wait_ns, MutableImageView into, ports::ImageFacts& facts) {
  if (into.width() != options_.width_px || into.height() != options_.height_px)
    return {StatusCode::kInvalidArgument, "the image's place has another size than the profile says"};
  const int64_t deadline_ns = clocks_.now_ns() + std::max<int64_t>(wait_ns, 0);
  while (!loaded_) {
    const Status status = retry(deadline_ns);
    if (!status.ok() && clocks_.now_ns() >= deadline_ns) return {StatusCode::kUnavailable, status.detail()};
  }
  const int64_t since_ns = clocks_.now_ns() - cursor_.epoch_ns();
  const int64_t tick = std::max(since_ns / options_.period_ns, last_tick_ + 1);
  const int64_t exposed_ns = cursor_.epoch_ns() + tick * options_.period_ns;
  clocks_.sleep_until(std::min(exposed_ns, deadline_ns));
  if (exposed_ns > deadline_ns) return {StatusCode::kUnavailable, "no image in that time"};
  copy(cursor_.at(exposed_ns).shot, into);
  facts = {};
  facts.exposed = {exposed_ns, ClockId::kMonotonic};
  facts.arrived_ns = clocks_.now_ns();
  facts.first_after_gap = sequence_ == 0;
  facts.sequence = sequence_++;
  last_tick_ = tick;
  health_.image(0, facts.arrived_ns);
  return ok_status();
}

}  // namespace roomcal::drivers
