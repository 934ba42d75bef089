#include "drivers/evdev/evdev_button.h"

#include <cerrno>
#include <cstring>
#include <ctime>

#include <fcntl.h>
#include <sys/stat.h>

#include "drivers/os/c_text.h"
#include "drivers/os/time_ns.h"

namespace roomcal::drivers {

namespace {

using KeyBits = std::array<uint8_t, KEY_CNT / 8>;

bool has(const KeyBits& bits, uint16_t code) { return code < KEY_CNT && (bits[code / 8] >> (code % 8) & 1) != 0; }

bool is_fifo(int fd) {
  struct stat info {};
  return ::fstat(fd, &info) == 0 && S_ISFIFO(info.st_mode);
}

}  // namespace

Status EvdevButton::check() const {
  if (options_.key_code == 0 || options_.key_code >= KEY_CNT)
    return {StatusCode::kInvalidArgument, "the button needs the code of its key; see evtest"};
  return check_path(options_.device);
}

Status EvdevButton::set_up(int fd) const {
  int clock = CLOCK_MONOTONIC;
  KeyBits keys{};
  if (kernel_.ioctl(fd, EVIOCSCLOCKID, &clock) < 0 || kernel_.ioctl(fd, EVIOCGBIT(EV_KEY, sizeof keys), &keys) < 0)
    return {StatusCode::kUnavailable, "the button's device is no input device; name one of /dev/input/by-path"};
  if (!has(keys, options_.key_code))
    return {StatusCode::kNotFound, "the button's device has no key of its code; see evtest"};
  return ok_status();
}

bool EvdevButton::is_down(int fd) const {
  KeyBits keys{};
  return kernel_.ioctl(fd, EVIOCGKEY(sizeof keys), &keys) >= 0 && has(keys, options_.key_code);
}

Status EvdevButton::open(bool& held) {
  ROOMCAL_TRY(check());
  const CText path(options_.device);
  UniqueFd fd(kernel_.open(path.c_str(), O_RDONLY | O_NONBLOCK));
  fifo_ = fd.valid() && is_fifo(fd.get());
  // With a writing end of our own, the FIFO does not hang up when a script closes its end.
  if (fifo_) fd = UniqueFd(kernel_.open(path.c_str(), O_RDWR | O_NONBLOCK));
  if (!fd.valid())
    return {StatusCode::kNotFound, "the button's device cannot be opened; check its path and permissions"};
  if (!fifo_) ROOMCAL_TRY(set_up(fd.get()));
  held = !fifo_ && is_down(fd.get());
  skipping_ = false;
  have_ = 0;
  fd_ = std::move(fd);
  return ok_status();
}

bool EvdevButton::read_event(input_event& event) {
  const long got = kernel_.read(fd_.get(), std::span(bytes_).subspan(have_));
  if (got == 0 || (got < 0 && got != -EAGAIN)) fd_.reset();
  if (got <= 0) return false;
  have_ += static_cast<std::size_t>(got);
  if (have_ < bytes_.size()) return false;
  have_ = 0;
  std::memcpy(&event, bytes_.data(), sizeof event);
  return true;
}

bool EvdevButton::read(Reading& reading) {
  input_event event{};
  if (!read_event(event)) return false;
  judge(event, reading);
  return true;
}

void EvdevButton::judge(const input_event& event, Reading& reading) {
  const int64_t told_ns = to_ns(int64_t{event.input_event_sec}, int64_t{event.input_event_usec} * 1000);
  reading.stamp_ns = told_ns == 0 ? now_ns() : told_ns;
  if (event.type == EV_SYN && event.code == SYN_DROPPED) skipping_ = true;
  if (skipping_) {
    if (event.type != EV_SYN || event.code != SYN_REPORT) return;
    skipping_ = false;
    reading.tells = !fifo_;
    reading.down = reading.tells && is_down(fd_.get());
    return;
  }
  constexpr int kRepeat = 2;
  reading.tells = event.type == EV_KEY && event.code == options_.key_code && event.value != kRepeat;
  reading.down = event.value != 0;
}

}  // namespace roomcal::drivers
