#include "drivers/v4l2/handle.h"

namespace roomcal::drivers {

Trouble V4l2Handle::open(std::string_view node) {
  close();
  const int result = uninterrupted([&] { return kernel_.open(node); });
  if (result < 0) return trouble_of(V4l2Call::kOpen, -result);
  fd_ = result;
  return {};
}

Trouble V4l2Handle::poll(int64_t timeout_ns, int& events) const {
  events = 0;
  return trouble(V4l2Call::kPoll, [&] {
    const int result = kernel_.poll(fd_, timeout_ns);
    if (result > 0) events = result;
    return result;
  });
}

}  // namespace roomcal::drivers
