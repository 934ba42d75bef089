#include "drivers/aravis/buffer_image.h"

#include <algorithm>
#include <cstddef>

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

ImageFault fault_of(ArvBufferStatus status) {
  switch (status) {
    case ARV_BUFFER_STATUS_SUCCESS:
      return ImageFault::kCount;
    case ARV_BUFFER_STATUS_TIMEOUT:
    case ARV_BUFFER_STATUS_MISSING_PACKETS:
      return ImageFault::kShort;
    case ARV_BUFFER_STATUS_SIZE_MISMATCH:
      return ImageFault::kFormat;
    default:  // WRONG_PACKET_ID, and of later versions PAYLOAD_NOT_SUPPORTED
      return ImageFault::kMarkedDamaged;
  }
}

bool is_as_set(ArvBuffer* buffer, const PfncFormat& format, int width_px, int height_px) {
  const ArvBufferPayloadType payload = arv_buffer_get_payload_type(buffer);
  return (payload == ARV_BUFFER_PAYLOAD_TYPE_IMAGE || payload == ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA) &&
         arv_buffer_get_image_pixel_format(buffer) == format.code && arv_buffer_get_image_width(buffer) == width_px &&
         arv_buffer_get_image_height(buffer) == height_px;
}

}  // namespace

bool is_unused(ArvBufferStatus status) {
  return status == ARV_BUFFER_STATUS_ABORTED || status == ARV_BUFFER_STATUS_CLEARED;
}

LibraryImage image_of(ArvBuffer* buffer, const PfncFormat& format, int width_px, int height_px) {
  LibraryImage image;
  image.slot = GPOINTER_TO_INT(arv_buffer_get_user_data(buffer));
  image.fault = fault_of(arv_buffer_get_status(buffer));
  if (image.fault != ImageFault::kCount) return image;
  if (!is_as_set(buffer, format, width_px, height_px)) {
    image.fault = ImageFault::kUndecodable;
    return image;
  }
  std::size_t size = 0;
  const void* data = arv_buffer_get_image_data(buffer, &size);
  gint padding_x = 0, padding_y = 0;
  arv_buffer_get_image_padding(buffer, &padding_x, &padding_y);
  const auto stride = static_cast<std::size_t>(width_px * format.bytes_per_px + std::max(padding_x, 0));
  image.raw = {format.layout, width_px, height_px, stride, {static_cast<const std::byte*>(data), size}};
  return image;
}

}  // namespace roomcal::drivers
