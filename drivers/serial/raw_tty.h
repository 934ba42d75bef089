#pragma once

#include <cstdint>

#include <termios.h>

#include "runtime/base/status.h"

namespace roomcal::drivers {

/// Makes a terminal pass every byte as it is: 8 data bits, no parity, one stop bit, no flow control, breaks ignored,
/// modem lines ignored.
/// @param baud  9600 to 3000000; 0: as it is.
/// @param keep_signals  Ctrl-C still interrupts: for somebody's own terminal.
/// @return kUnsupported for what is no terminal; kInvalidArgument for a rate that is none or that it cannot do.
Status make_raw(int fd, uint32_t baud, bool keep_signals);

}  // namespace roomcal::drivers
