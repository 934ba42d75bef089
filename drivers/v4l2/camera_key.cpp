#include "drivers/v4l2/camera_key.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace roomcal::drivers {

namespace {

constexpr std::string_view kAnd = " + ";
constexpr std::string_view kLinks = "/dev/v4l/by-";

// Cuts the first part off `rest`; all of it if there is no separator.
std::string_view cut(std::string_view& rest, std::string_view separator) {
  const std::size_t end = rest.find(separator);
  const std::string_view part = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + separator.size());
  return part;
}

struct Condition {
  std::string_view kind, value;
};

Condition next_condition(std::string_view& rest) {
  std::string_view value = cut(rest, kAnd);
  const std::string_view kind = cut(value, ":");
  return {kind, value};
}

bool known(std::string_view kind) {
  constexpr std::array<std::string_view, 5> kKinds = {"port", "serial", "name", "bus", "index"};
  return std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end();
}

int to_index(std::string_view text) {
  int index = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  return error == std::errc() && end == text.data() + text.size() ? index : -1;
}

// "*-2" is "-2" behind any number; everything else is itself.
bool part_fits(std::string_view pattern, std::string_view part) {
  if (pattern.substr(0, 2) != "*-") return pattern == part;
  const std::size_t bus = std::min(part.find_first_not_of("0123456789"), part.size());
  return bus > 0 && part.substr(bus) == pattern.substr(1);
}

bool path_fits(std::string_view pattern, std::string_view path) {
  while (!pattern.empty()) {
    const std::string_view wanted = cut(pattern, "/");
    bool found = false;
    while (!found && !path.empty()) found = part_fits(wanted, cut(path, "/"));
    if (!found) return false;
  }
  return true;
}

bool name_fits(std::string_view wanted, std::string_view title) {
  return title.substr(0, wanted.size()) == wanted && (title.size() == wanted.size() || title[wanted.size()] == ':');
}

bool condition_fits(const Condition& condition, const VideoNode& node) {
  if (condition.kind == "port") return path_fits(condition.value, node.path.view());
  if (condition.kind == "serial") return condition.value == node.serial.view();
  if (condition.kind == "name") return name_fits(condition.value, node.title.view());
  if (condition.kind == "index") return to_index(condition.value) == node.index;
  return true;  // of the bus only the open device knows
}

std::string_view last_part(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

}  // namespace

Status CameraKey::check(std::string_view key) {
  if (key.empty()) return {StatusCode::kInvalidArgument, "the camera has no key; give its port or serial number"};
  if (key.substr(0, kLinks.size()) == kLinks) return ok_status();
  if (key.substr(0, 5) == "/dev/")
    return {StatusCode::kInvalidArgument,
            "a device number changes when cameras are plugged; give port:, serial:, name:, bus: or /dev/v4l/by-path/"};
  bool more = true;
  while (more) {
    more = key.find(kAnd) != std::string_view::npos;
    const Condition condition = next_condition(key);
    if (!known(condition.kind) || condition.value.empty())
      return {StatusCode::kInvalidArgument,
              "the camera's key has a part that is not port:, serial:, name:, bus:, index:"};
    if (condition.kind == "index" && to_index(condition.value) < 0)
      return {StatusCode::kInvalidArgument, "the index in the camera's key is not a number"};
  }
  return ok_status();
}

bool CameraKey::is_link() const { return key_.substr(0, kLinks.size()) == kLinks; }

bool CameraKey::fits(const VideoNode& node, std::string_view link) const {
  if (is_link()) return node.name.view() == last_part(link);
  for (std::string_view rest = key_; !rest.empty();)
    if (!condition_fits(next_condition(rest), node)) return false;
  return true;
}

bool CameraKey::fits_bus(std::string_view bus_info) const {
  if (is_link()) return true;
  for (std::string_view rest = key_; !rest.empty();) {
    const Condition condition = next_condition(rest);
    if (condition.kind == "bus" && condition.value != bus_info) return false;
  }
  return true;
}

}  // namespace roomcal::drivers
