#include "drivers/v4l2/device.h"

#include <algorithm>
#include <array>

#include <linux/videodev2.h>
#include <poll.h>

#include "drivers/v4l2/caps.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

using ports::ImageFault;

Trouble V4l2Device::open() {
  close();
  Trouble trouble = find_and_open();
  if (trouble.none()) trouble = configure();
  if (trouble.none()) trouble = stream_on();
  if (trouble.none()) {
    tell_what_it_is();
  } else if (trouble.fault == ImageFault::kGone) {
    abandon();
  } else {
    close();
  }
  return trouble;
}

Trouble V4l2Device::find_and_open() {
  const CameraKey key(options_.key.view());
  FoundCamera found;
  const Trouble trouble = find_camera(kernel_, key, found);
  if (!found.others.empty()) {
    FixedText<200> line("the key fits more than one, add port: or index: to it: ");
    line.append(found.others.view());
    log_.note_once(line.view());
  }
  if (!trouble.none()) return trouble;
  node_ = found.node;
  ROOMCAL_TRY_CALL(handle_.open(node_.name.view()));
  return still_the_same(key);
}

// Between finding and opening, a number may have gone to another camera. Once it is open, its number is ours.
Trouble V4l2Device::still_the_same(const CameraKey& key) {
  VideoNode node;
  const int described = kernel_.describe(node_.name.view(), node);
  if (described < 0) return trouble_of(V4l2Call::kFind, -described);
  const bool same = node.path.view() == node_.path.view() && (key.is_link() || key.fits(node, {}));
  return same ? Trouble{} : Trouble{ImageFault::kStale, 0};
}

Trouble V4l2Device::configure() {
  CameraCaps caps;
  ROOMCAL_TRY_CALL(query_caps(handle_, caps));
  multiplanar_ = caps.multiplanar;
  guard_.remember(multiplanar_);
  const Trouble trouble = set_format(handle_, multiplanar_, options_, format_);
  if (trouble.fault == ImageFault::kFormat) tell_offer();
  if (!trouble.none()) return trouble;
  ROOMCAL_TRY_CALL(apply_settings(handle_, multiplanar_, options_, guard_, log_, timing_));
  listen();
  return ring_.reserve(multiplanar_, std::clamp(options_.buffers, 4, BufferRing::kMost), format_.buffer_bytes);
}

// Not every driver has events; those without tell by their errors.
void V4l2Device::listen() {
  for (const uint32_t type : {V4L2_EVENT_SOURCE_CHANGE, V4L2_EVENT_EOS}) {
    auto subscription = zeroed<v4l2_event_subscription>();
    subscription.type = type;
    static_cast<void>(handle_.call(V4l2Call::kEvent, VIDIOC_SUBSCRIBE_EVENT, subscription));
  }
}

Trouble V4l2Device::stream_on() {
  ROOMCAL_TRY_CALL(ring_.queue_all());
  auto type = static_cast<int>(buffer_type(multiplanar_));
  return handle_.call(V4l2Call::kStreamOn, VIDIOC_STREAMON, type);
}

// What it says does not matter: a driver that cannot stop shows it when it is to start.
void V4l2Device::stream_off() {
  auto type = static_cast<int>(buffer_type(multiplanar_));
  static_cast<void>(handle_.call(V4l2Call::kStreamOn, VIDIOC_STREAMOFF, type));
  ring_.take_back();
}

Trouble V4l2Device::restart() {
  if (!is_open()) return {ImageFault::kStale, 0};
  stream_off();
  return stream_on();
}

void V4l2Device::close() {
  if (!is_open()) return;
  stream_off();
  ring_.release();
  guard_.restore();
  handle_.close();
}

void V4l2Device::abandon() {
  ring_.unmap();
  guard_.forget();
  handle_.close();
}

Trouble V4l2Device::reset_port() {
  close();
  const std::string_view device = usb_device_of(node_.path.view());
  if (device.empty()) return {ImageFault::kStale, 0};
  const int result = kernel_.reset_usb_device(device);
  return result < 0 ? trouble_of(V4l2Call::kOpen, -result) : Trouble{};
}

Trouble V4l2Device::wait(int64_t timeout_ns, bool& ready) {
  int events = 0;
  ready = false;
  ROOMCAL_TRY_CALL(handle_.poll(timeout_ns, events));
  if ((events & POLLPRI) != 0) ROOMCAL_TRY_CALL(read_event());
  if ((events & POLLNVAL) != 0) return {ImageFault::kStale, 0};
  ready = (events & POLLIN) != 0;
  // A queue in error gives nothing until the stream is stopped (vb2_queue_error). Whether the camera is gone as well,
  // the next call tells.
  return (events & (POLLERR | POLLHUP)) != 0 ? Trouble{ImageFault::kEndOfStream, 0} : Trouble{};
}

Trouble V4l2Device::read_event() {
  auto event = zeroed<v4l2_event>();
  ROOMCAL_TRY_CALL(handle_.call(V4l2Call::kEvent, VIDIOC_DQEVENT, event));
  if (event.type == V4L2_EVENT_SOURCE_CHANGE) return {ImageFault::kStale, 0};
  return event.type == V4L2_EVENT_EOS ? Trouble{ImageFault::kEndOfStream, 0} : Trouble{};
}

void V4l2Device::tell_offer() const {
  std::array<char, 160> line;
  TextWriter out(line);
  out.text("asked for ").integer(options_.width_px).text("x").integer(options_.height_px);
  for (const PixelFormat format : options_.formats) out.text(" ").text(to_string(format));
  out.text("; it offers ").integer(format_.width_px).text("x").integer(format_.height_px);
  out.text(" ").text(fourcc_text(format_.fourcc).view());
  log_.note_once(out.view());
}

void V4l2Device::tell_what_it_is() const {
  std::array<char, 200> line;
  TextWriter out(line);
  out.text("is /dev/")
      .text(node_.name.view())
      .text(", ")
      .integer(format_.width_px)
      .text("x")
      .integer(format_.height_px);
  out.text(" ").text(fourcc_text(format_.fourcc).view()).text(", ").text(node_.title.view());
  log_.note_once(out.view());
}

std::string_view usb_device_of(std::string_view path) {
  // ".../1-2.3/1-2.3:1.0": the interface, and before it the device.
  const std::size_t slash = path.rfind('/');
  if (slash == std::string_view::npos) return {};
  const std::string_view interface = path.substr(slash + 1), above = path.substr(0, slash);
  const std::string_view device = interface.substr(0, interface.find(':'));
  const bool usb = device.size() < interface.size() && device.find('-') != std::string_view::npos &&
                   above.size() >= device.size() && above.substr(above.size() - device.size()) == device;
  return usb ? device : std::string_view();
}

}  // namespace roomcal::drivers
