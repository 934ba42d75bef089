#include "drivers/serial/raw_tty.h"

#include <algorithm>
#include <array>
#include <utility>

namespace roomcal::drivers {

namespace {

constexpr std::array<std::pair<uint32_t, speed_t>, 12> kRates = {{{9600, B9600},
                                                                  {19200, B19200},
                                                                  {38400, B38400},
                                                                  {57600, B57600},
                                                                  {115200, B115200},
                                                                  {230400, B230400},
                                                                  {460800, B460800},
                                                                  {921600, B921600},
                                                                  {1000000, B1000000},
                                                                  {1500000, B1500000},
                                                                  {2000000, B2000000},
                                                                  {3000000, B3000000}}};

}  // namespace

Status make_raw(int fd, uint32_t baud, bool keep_signals) {
  constexpr Status kNoSuchRate(StatusCode::kInvalidArgument, "the serial line cannot do this rate; most do 115200");
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) return {StatusCode::kUnsupported, "is no serial line"};
  ::cfmakeraw(&settings);
  settings.c_iflag |= IGNBRK;
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  if (keep_signals) settings.c_lflag |= ISIG;
  settings.c_cc[VMIN] = 1;  // a read of nothing then tells a line that hung up from one that is silent
  settings.c_cc[VTIME] = 0;
  if (baud != 0) {
    const auto* rate = std::find_if(kRates.begin(), kRates.end(), [&](const auto& row) { return row.first == baud; });
    if (rate == kRates.end() || ::cfsetspeed(&settings, rate->second) != 0) return kNoSuchRate;
  }
  // The call succeeds if any of it could be done.
  termios set{};
  const bool done = ::tcsetattr(fd, TCSANOW, &settings) == 0 && ::tcgetattr(fd, &set) == 0;
  return done && ::cfgetospeed(&set) == ::cfgetospeed(&settings) ? ok_status() : kNoSuchRate;
}

}  // namespace roomcal::drivers
