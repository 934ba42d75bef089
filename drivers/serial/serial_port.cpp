#include "drivers/serial/serial_port.h"

#include <cerrno>

#include <fcntl.h>

#include "drivers/os/c_text.h"
#include "drivers/serial/raw_tty.h"

namespace roomcal::drivers {

namespace {

constexpr int kFlags = O_NOCTTY | O_NONBLOCK;

}  // namespace

Status SerialPort::open_standard() {
  UniqueFd in(kernel_.open("/proc/self/fd/0", O_RDONLY | kFlags));
  UniqueFd out(kernel_.open("/proc/self/fd/1", O_WRONLY | O_APPEND | kFlags));
  if (!in.valid() || !out.valid())
    return {StatusCode::kUnavailable, "standard input or output cannot be opened; use a terminal, a pipe or a file"};
  give_back_ = ::tcgetattr(in.get(), &before_) == 0;
  if (give_back_) ROOMCAL_TRY(make_raw(in.get(), 0, true));
  in_ = std::move(in);
  out_ = std::move(out);
  return ok_status();
}

Status SerialPort::open() {
  if (standard()) return open_standard();
  UniqueFd line(kernel_.open(CText(options_.device).c_str(), O_RDWR | kFlags));
  if (!line.valid())
    return {StatusCode::kUnavailable, "the serial line cannot be opened; check its path and permissions"};
  ROOMCAL_TRY(make_raw(line.get(), options_.baud, false));
  in_ = std::move(line);
  return ok_status();
}

Status SerialPort::start() {
  stop();
  times_lost_ = 0;
  ROOMCAL_TRY(check_path(options_.device));
  const Status opened = open();
  wanted_ = opened.code() != StatusCode::kInvalidArgument;
  static_cast<void>(retry_.due(clocks_.now_ns()));
  return opened;
}

void SerialPort::stop() {
  if (give_back_ && in_.valid()) ::tcsetattr(in_.get(), TCSANOW, &before_);
  wanted_ = give_back_ = false;
  in_.reset();
  out_.reset();
}

bool SerialPort::there() {
  if (in_.valid()) return true;
  return wanted_ && retry_.due(clocks_.now_ns()) && open().ok();
}

void SerialPort::lose() {
  ++times_lost_;
  in_.reset();
  if (standard()) wanted_ = false;  // there is no other one
}

std::size_t SerialPort::read_some(std::span<char> into) {
  if (into.empty() || !there()) return 0;
  const long got = kernel_.read(in_.get(), std::as_writable_bytes(into));
  if (got > 0) return static_cast<std::size_t>(got);
  if (got != -EAGAIN) lose();
  return 0;
}

/// The last answers still leave when standard input has ended.
std::size_t SerialPort::write_some(std::span<const char> bytes) {
  if (bytes.empty() || (standard() ? !out_.valid() : !there())) return 0;
  const long put = kernel_.write(standard() ? out_.get() : in_.get(), std::as_bytes(bytes));
  if (put >= 0) return static_cast<std::size_t>(put);
  if (put == -EAGAIN) return 0;
  lose();
  out_.reset();
  return 0;
}

}  // namespace roomcal::drivers
