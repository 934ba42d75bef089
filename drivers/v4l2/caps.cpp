#include "drivers/v4l2/caps.h"

#include <linux/videodev2.h>

namespace roomcal::drivers {

Trouble query_caps(const V4l2Handle& handle, CameraCaps& caps) {
  auto answer = zeroed<v4l2_capability>();
  ROOMCAL_TRY_CALL(handle.call(V4l2Call::kQueryCaps, VIDIOC_QUERYCAP, answer));
  const uint32_t of_node = (answer.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? answer.device_caps : answer.capabilities;
  const bool single = (of_node & V4L2_CAP_VIDEO_CAPTURE) != 0, multi = (of_node & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
  caps.card = field_text(answer.card);
  caps.bus_info = field_text(answer.bus_info);
  caps.delivers_images = (single || multi) && (of_node & V4L2_CAP_STREAMING) != 0;
  caps.multiplanar = multi && !single;
  return {};
}

}  // namespace roomcal::drivers
