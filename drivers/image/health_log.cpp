#include "drivers/image/health_log.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "runtime/base/crc32c.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

using Line = std::array<char, 200>;

}  // namespace

void HealthLog::start() {
  health_ = {};
  rows_ = {};
  notes_.clear();
  told_ = 0;
  gave_up_ = false;
}

void HealthLog::image(uint32_t lost, int64_t now_ns) {
  ++health_.images;
  health_.lost += lost;
  if (told_ > 0) tell_what_is_over(now_ns);
}

void HealthLog::tell_what_is_over(int64_t now_ns) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    if (!row.told || now_ns - row.last_ns < kQuietNs || health_.images - row.last_images < kQuietImages) continue;
    Line line;
    TextWriter out(line);
    out.text("over: ").text(to_string(static_cast<ImageFault>(i))).text(", ").unsigned_integer(row.count);
    out.text(row.count == 1 ? " time" : " times");
    log_.note(who(), out.view());
    row = {};
    --told_;
  }
}

void HealthLog::fault(ImageFault fault, int64_t now_ns, int error_number) {
  const auto i = static_cast<std::size_t>(fault);
  if (i >= rows_.size()) return;
  ++health_.faults[i];
  health_.last_fault = fault;
  health_.error_number = error_number;
  Row& row = rows_[i];
  ++row.count;
  row.last_ns = now_ns;
  row.last_images = health_.images;
  if (row.told) return;
  row.told = true;
  ++told_;
  Line line;
  TextWriter out(line);
  out.text(to_string(fault)).text("; ").text(remedy(fault));
  if (error_number != 0) out.text(" (errno ").integer(error_number).text(")");
  log_.note(who(), out.view());
}

void HealthLog::step(RecoveryStep step) {
  if (step == RecoveryStep::kRestartStream) ++health_.restarts;
  if (step == RecoveryStep::kReopen) ++health_.reopens;
  if (step == RecoveryStep::kResetPort) ++health_.port_resets;
  if (step != RecoveryStep::kGiveUp || gave_up_) return;
  gave_up_ = true;
  Line line;
  TextWriter out(line);
  out.text("given up after ")
      .unsigned_integer(health_.restarts)
      .text(" restarts and ")
      .unsigned_integer(health_.reopens);
  out.text(" reopens: ").text(to_string(health_.last_fault)).text("; ").text(remedy(health_.last_fault));
  log_.note(who(), out.view());
}

void HealthLog::note_once(std::string_view what) {
  const uint32_t sum = crc32c(std::as_bytes(std::span(what)));
  if (std::find(notes_.begin(), notes_.end(), sum) != notes_.end()) return;
  if (!notes_.push_back(sum)) return;
  note(what);
}

}  // namespace roomcal::drivers
