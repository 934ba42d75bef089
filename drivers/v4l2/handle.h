#pragma once

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "drivers/v4l2/kernel.h"
#include "drivers/v4l2/trouble.h"

namespace roomcal::drivers {

/// A kernel's structure with every byte zero, as its reserved fields must be: `{}` leaves the rest of a union open.
template <typename T>
T zeroed() {
  static_assert(std::is_trivially_copyable_v<T>);
  T value;
  std::memset(&value, 0, sizeof value);
  return value;
}

/// The one owner of an open video node.
class V4l2Handle {
 public:
  explicit V4l2Handle(V4l2Kernel& kernel) : kernel_(kernel) {}
  ~V4l2Handle() { close(); }
  V4l2Handle(const V4l2Handle&) = delete;
  V4l2Handle& operator=(const V4l2Handle&) = delete;

  Trouble open(std::string_view node);
  void close() {
    if (fd_ >= 0) kernel_.close(std::exchange(fd_, -1));
  }
  bool is_open() const { return fd_ >= 0; }

  /// A call that signals interrupt is taken up again, four times: more of them in a row are an error like another.
  /// @param call  what for: the same errno means different things.
  template <typename T>
  Trouble call(V4l2Call call, unsigned long request, T& argument) const {
    return trouble(call, [&] { return kernel_.ioctl(fd_, request, &argument); });
  }
  Trouble map(std::size_t size, int64_t offset, std::span<const std::byte>& bytes) const {
    return trouble(V4l2Call::kMap, [&] { return kernel_.map(fd_, size, offset, bytes); });
  }
  void unmap(std::span<const std::byte> bytes) const { kernel_.unmap(bytes); }
  /// @param[out] events  of poll(2); 0: none in that time.
  Trouble poll(int64_t timeout_ns, int& events) const;

 private:
  template <typename Call>
  Trouble trouble(V4l2Call what, const Call& call) const {
    const int result = uninterrupted(call);
    return result < 0 ? trouble_of(what, -result) : Trouble{};
  }
  template <typename Call>
  static int uninterrupted(const Call& call);

  V4l2Kernel& kernel_;
  int fd_ = -1;
};

template <typename Call>
int V4l2Handle::uninterrupted(const Call& call) {
  constexpr int kTries = 5;
  int result = -EINTR;
  for (int i = 0; i < kTries && result == -EINTR; ++i) result = call();
  return result;
}

}  // namespace roomcal::drivers
