#include "drivers/watchdog/service_notifier.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>

#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

constexpr std::size_t kMaxStatus = 200;

bool read_number(std::string_view text, int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

Status ServiceNotifier::start(const char* socket) {
  fd_.reset();
  unsent_ = 0;
  const std::string_view name = socket == nullptr ? "" : socket;
  if (name.empty()) return ok_status();
  if ((name[0] != '/' && name[0] != '@') || name.size() >= sizeof address_.sun_path)
    return {StatusCode::kInvalidArgument, "NOTIFY_SOCKET is no path and no abstract name"};
  address_ = {};
  address_.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), address_.sun_path);
  if (name[0] == '@') address_.sun_path[0] = '\0';
  address_bytes_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
  fd_ = UniqueFd(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const UniqueFd trial(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (::connect(trial.get(), reinterpret_cast<const sockaddr*>(&address_), address_bytes_) != 0)
    return {StatusCode::kUnavailable, "nobody listens to NOTIFY_SOCKET; is the service manager up?"};
  return ok_status();
}

void ServiceNotifier::send(std::string_view message) {
  if (!fd_.valid()) return;
  const ssize_t sent = ::sendto(fd_.get(), message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                                reinterpret_cast<const sockaddr*>(&address_), address_bytes_);
  unsent_ += sent == static_cast<ssize_t>(message.size()) ? 0 : 1;
}

void ServiceNotifier::ready() { send("READY=1"); }
void ServiceNotifier::stopping() { send("STOPPING=1"); }
void ServiceNotifier::feed() { send("WATCHDOG=1"); }

void ServiceNotifier::status(std::string_view text) {
  std::array<char, kMaxStatus + 16> message{};
  TextWriter out(message);
  out.text("STATUS=");
  // A line's end would begin another assignment.
  for (const char c : text.substr(0, kMaxStatus)) out.character(static_cast<unsigned char>(c) < ' ' ? ' ' : c);
  send(out.view());
}

int64_t service_watchdog_ns(const char* watchdog_usec, const char* watchdog_pid, int64_t own_pid) {
  int64_t usec = 0, pid = own_pid;
  if (watchdog_usec == nullptr || !read_number(watchdog_usec, usec)) return 0;
  if (watchdog_pid != nullptr && !read_number(watchdog_pid, pid)) return 0;
  if (pid != own_pid || usec <= 0 || usec > INT64_MAX / 1000) return 0;
  return usec * 1000;
}

}  // namespace roomcal::drivers
