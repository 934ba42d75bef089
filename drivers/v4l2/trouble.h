#pragma once

#include <cstdint>

#include "runtime/ports/image_source.h"

namespace roomcal::drivers {

/// What the driver was doing when the kernel said no.
enum class V4l2Call : uint8_t {
  kFind,            ///< reading sysfs
  kOpen,            ///<
  kQueryCaps,       ///< VIDIOC_QUERYCAP
  kSetFormat,       ///< VIDIOC_G_FMT, VIDIOC_S_FMT
  kSetRate,         ///< VIDIOC_G_PARM, VIDIOC_S_PARM
  kControl,         ///< VIDIOC_QUERYCTRL, VIDIOC_G_CTRL, VIDIOC_S_CTRL
  kRequestBuffers,  ///< VIDIOC_REQBUFS, VIDIOC_QUERYBUF
  kMap,             ///<
  kQueue,           ///< VIDIOC_QBUF
  kStreamOn,        ///< VIDIOC_STREAMON
  kPoll,            ///<
  kDequeue,         ///< VIDIOC_DQBUF
  kEvent,           ///< VIDIOC_SUBSCRIBE_EVENT, VIDIOC_DQEVENT
  kCount
};

/// A step that did not succeed; none by default.
struct [[nodiscard]] Trouble {
  ports::ImageFault fault = ports::ImageFault::kCount;
  int error_number = 0;

  bool none() const { return fault == ports::ImageFault::kCount; }
};

/// What an errno means, by the one table that there is of it (trouble.cpp).
/// @param error_number  positive. That nothing is there to be dequeued is no trouble; the number tells it from success.
Trouble trouble_of(V4l2Call call, int error_number);

}  // namespace roomcal::drivers

/// Returns the trouble of `expression` from the enclosing function unless there is none.
#define ROOMCAL_TRY_CALL(expression)                                                                  \
  do {                                                                                                \
    if (const ::roomcal::drivers::Trouble try_call = (expression); !try_call.none()) return try_call; \
  } while (false)
