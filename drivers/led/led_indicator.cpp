#include "drivers/led/led_indicator.h"

#include <algorithm>
#include <array>

#include <fcntl.h>

#include "drivers/os/unique_fd.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

constexpr std::string_view kBrightness = "brightness", kMaxBrightness = "max_brightness", kTrigger = "trigger";

using Path = std::array<char, 160>;

Path path_of(const LedOptions& options, std::string_view file) {
  Path path{};
  TextWriter({path.data(), path.size() - 1}).text(options.folder.view()).text("/").text(file);
  return path;
}

std::string_view first_line(std::string_view text) { return text.substr(0, text.find('\n')); }

/// The one in brackets of "none [heartbeat] timer", or the only word of a plain file; empty if the list is cut before
/// it.
std::string_view chosen(std::string_view triggers) {
  const std::size_t open = triggers.find('['), close = triggers.find(']');
  if (open != std::string_view::npos && close != std::string_view::npos && close > open)
    return triggers.substr(open + 1, close - open - 1);
  const std::string_view line = first_line(triggers);
  return line.find(' ') == std::string_view::npos ? line : std::string_view();
}

}  // namespace

long LedIndicator::read_file(std::string_view name, std::span<char> into) const {
  const UniqueFd fd(kernel_.open(path_of(options_, name).data(), O_RDONLY));
  return fd.valid() ? kernel_.read(fd.get(), std::as_writable_bytes(into)) : -1;
}

bool LedIndicator::write_file(std::string_view name, std::string_view text) const {
  const UniqueFd fd(kernel_.open(path_of(options_, name).data(), O_WRONLY | O_CREAT | O_TRUNC));
  return fd.valid() && kernel_.write(fd.get(), std::as_bytes(std::span(text))) == static_cast<long>(text.size());
}

Status LedIndicator::start() {
  stop();
  ROOMCAL_TRY(check_path(options_.folder));
  std::array<char, 4096> text{};  // a page, as sysfs gives at most; the list of triggers is long
  const auto content = [&](std::string_view name) {
    return std::string_view(text.data(), static_cast<std::size_t>(std::max(read_file(name, text), 0L)));
  };
  const std::string_view triggers = content(kTrigger);
  const bool has_trigger = !triggers.empty();
  trigger_before_ = chosen(triggers);
  brightness_before_ = first_line(content(kBrightness));
  full_ = first_line(content(kMaxBrightness));
  if (full_.empty()) full_ = "1";
  if (has_trigger && !write_file(kTrigger, "none"))
    return {StatusCode::kUnavailable, "the lamp's trigger cannot be taken off; check the permissions in its folder"};
  if (!show(false))
    return {StatusCode::kUnavailable, "the lamp cannot be written; check its folder below /sys/class/leds"};
  started_ = true;
  return ok_status();
}

bool LedIndicator::show(bool lit) {
  const bool written = write_file(kBrightness, lit ? full_.view() : "0");
  shown_ = !written ? Shown::kUnknown : lit ? Shown::kLit : Shown::kDark;
  return written;
}

void LedIndicator::set(bool lit) {
  if (started_ && shown_ != (lit ? Shown::kLit : Shown::kDark)) static_cast<void>(show(lit));
}

/// The brightness first: writing 0 takes a trigger off.
void LedIndicator::stop() {
  if (!started_) return;
  started_ = false;
  if (!brightness_before_.empty()) static_cast<void>(write_file(kBrightness, brightness_before_.view()));
  if (!trigger_before_.empty()) static_cast<void>(write_file(kTrigger, trigger_before_.view()));
}

}  // namespace roomcal::drivers
