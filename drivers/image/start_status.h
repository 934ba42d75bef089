#pragma once

#include "runtime/base/status.h"
#include "runtime/ports/image_source.h"

namespace roomcal::drivers {

/// What ports::ImageSource::start() says about a fault: code and one line with the remedy. kOk for kCount.
Status start_status(ports::ImageFault fault);

}  // namespace roomcal::drivers
