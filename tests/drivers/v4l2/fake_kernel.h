#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <linux/videodev2.h>

#include "drivers/v4l2/kernel.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers::test {

/// Time that passes only when somebody waits, and a little with every call.
class FakeClocks final : public ports::SystemClocks {
 public:
  int64_t now_ns() const override { return now_ns_; }
  Stamp read(ClockId clock) const override { return {now_ns_, clock}; }
  void sleep_until(int64_t deadline_ns) const override { advance_to(deadline_ns); }
  void advance_to(int64_t ns) const {
    if (ns > now_ns_) now_ns_ = ns;
  }

 private:
  mutable int64_t now_ns_ = 1'000'000'000'000;
};

/// Every kind of call that the driver makes.
enum class FakeCall : uint8_t {
  kOpen,
  kQueryCap,
  kGetFormat,
  kSetFormat,
  kGetRate,
  kSetRate,
  kQueryControl,
  kGetControl,
  kSetControl,
  kRequestBuffers,
  kQueryBuffer,
  kMap,
  kQueue,
  kStreamOn,
  kStreamOff,
  kPoll,
  kDequeue,
  kSubscribe,
  kDequeueEvent,
  kList,
  kDescribe,
  kReadLink,
  kReset,
  kCount
};
const char* to_string(FakeCall call);

/// A camera and its driver, as videobuf2 behaves. Set up the public members, then plug it in.
struct FakeCamera {
  static constexpr int kBuffers = 8;
  static constexpr int kBytes = 8192;  ///< of a buffer

  VideoNode node;
  const char* card = "Fake";
  const char* bus_info = "usb-0000:00:14.0-2";
  uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  FixedVector<uint32_t, 4> fourccs;  ///< the first is what it falls back to
  int width = 64, height = 48;
  int stride = 64;
  int luma_step = 1, luma_at = 0;  ///< where in a row its bytes are: 2 and 0 for YUYV
  int64_t period_ns = 33'333'333;
  bool has_rate = true;
  uint32_t first_sequence = 0;
  uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;

  // Scripted from now on, for as long as they are set.
  bool silent = false;        ///< no images, no errors
  bool frozen_stamp = false;  ///< the stamp of the image before
  bool frozen_sequence = false;
  int64_t stamp_offset_ns = 0;
  uint32_t damage_flags = 0;        ///< V4L2_BUF_FLAG_ERROR
  int missing_bytes = 0;            ///< of each image
  int lose_next = 0;                ///< so many images take a number and do not come
  std::span<const std::byte> jpeg;  ///< what it sends instead of pixels, if there is any
  int returned_index = -1;          ///< of every image, instead of its own; 100: none that there is
  bool plugged = false;

  struct Control {
    uint32_t id;
    const char* name;
    int32_t value, low, high;
  };
  FixedVector<Control, 8> controls;
};

/// The kernel with up to four cameras. Calls can be made to fail: the n-th of a kind, so many times, with an errno.
/// No heap, so that it can stand in a test of the driver's own.
class FakeKernel final : public V4l2Kernel {
 public:
  explicit FakeKernel(const FakeClocks& clocks) : clocks_(clocks) {}

  /// @return the camera, not plugged in yet.
  FakeCamera& add(const char* node, const char* path, const char* serial = "");
  void plug(FakeCamera& camera, const char* node);
  /// Descriptors of it answer ENODEV from now on.
  void unplug(FakeCamera& camera);
  /// vb2_queue_error().
  void break_queue(FakeCamera& camera);
  void raise_event(FakeCamera& camera, uint32_t type);

  /// The calls of this kind from the `skip`-th on, `times` of them, fail.
  void fail(FakeCall call, int error_number, int skip = 0, int times = 1'000'000'000);
  void heal() { script_.clear(); }
  /// Just before the next call of this kind, `then` is done: what happens between two calls.
  void before(FakeCall call, void (*then)(FakeKernel&)) {
    hook_call_ = call;
    hook_ = then;
  }
  void link_to(const char* target) { link_ = target; }

  int calls(FakeCall call) const { return counts_[static_cast<std::size_t>(call)]; }
  int open_descriptors() const;
  int mappings() const { return mappings_; }
  /// Calls that the script made fail.
  int failed() const { return failed_; }
  /// Things that no driver may do: unmapping what is not mapped, queueing a buffer twice, using a closed descriptor.
  int misuses() const { return misuses_; }
  FakeCamera& camera(int i) { return cameras_[static_cast<std::size_t>(i)].is; }

  int open(std::string_view node) override;
  void close(int fd) override;
  int ioctl(int fd, unsigned long request, void* argument) override;
  int map(int fd, std::size_t size, int64_t offset, std::span<const std::byte>& bytes) override;
  void unmap(std::span<const std::byte> bytes) override;
  int poll(int fd, int64_t timeout_ns) override;
  int list(std::span<NodeName> names) override;
  int describe(std::string_view name, VideoNode& node) override;
  int read_link(std::string_view path, FixedText<255>& target) override;
  int reset_usb_device(std::string_view device) override;

 private:
  template <typename T, std::size_t kCapacity>
  static T pop_front(FixedVector<T, kCapacity>& items) {
    const T first = items[0];
    std::copy(items.begin() + 1, items.end(), items.begin());
    items.pop_back();
    return first;
  }

  struct Done {
    uint32_t index, sequence, flags, bytes;
    int64_t stamp_ns;
  };
  struct Driver {
    FakeCamera is;
    std::array<std::array<std::byte, FakeCamera::kBytes>, FakeCamera::kBuffers> memory{};
    FixedVector<uint32_t, FakeCamera::kBuffers> queue;
    FixedVector<Done, FakeCamera::kBuffers> done;
    FixedVector<uint32_t, 4> events;
    uint32_t allocated = 0, sequence = 0, fourcc = 0;
    int64_t next_ns = 0, last_stamp_ns = 0;
    bool streaming = false, broken = false;
    int owner = -1;  // the descriptor with the buffers
  };
  struct Descriptor {
    bool used = false, alive = false;
    int camera = 0;
  };
  struct Failure {
    FakeCall call;
    int error_number, skip, times;
  };

  bool multiplanar(const Driver& driver) const { return (driver.is.capabilities & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0; }
  int enter(FakeCall call);
  Driver* at(int fd);
  void produce(Driver& driver, int64_t until_ns);
  void expose(Driver& driver);
  void free_buffers(Driver& driver);
  int answer(Driver& driver, int fd, unsigned long request, void* argument);
  int query_cap(const Driver& driver, v4l2_capability& caps) const;
  int get_format(const Driver& driver, v4l2_format& format) const;
  int set_format(Driver& driver, v4l2_format& format);
  int rate(Driver& driver, v4l2_streamparm& rate, bool set);
  int query_control(const Driver& driver, v4l2_queryctrl& query) const;
  int control(Driver& driver, v4l2_control& control, bool set);
  int request_buffers(Driver& driver, int fd, v4l2_requestbuffers& request);
  int query_buffer(const Driver& driver, v4l2_buffer& buffer) const;
  int queue_buffer(Driver& driver, const v4l2_buffer& buffer);
  int dequeue_buffer(Driver& driver, v4l2_buffer& buffer);
  int dequeue_event(Driver& driver, v4l2_event& event);

  const FakeClocks& clocks_;
  std::array<Driver, 4> cameras_{};
  int camera_count_ = 0;
  std::array<Descriptor, 64> descriptors_{};
  FixedVector<Failure, 4> script_;
  std::array<int, static_cast<std::size_t>(FakeCall::kCount)> counts_{};
  FakeCall hook_call_ = FakeCall::kCount;
  void (*hook_)(FakeKernel&) = nullptr;
  const char* link_ = nullptr;
  int mappings_ = 0;
  int misuses_ = 0;
  int failed_ = 0;
};

}  // namespace roomcal::drivers::test
