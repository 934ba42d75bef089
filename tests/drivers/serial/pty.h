#pragma once

#include <array>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include "drivers/os/unique_fd.h"

namespace roomcal::drivers::test {

/// A pseudo-terminal: the test is at its near end, the device at the path of its far end.
class Pty {
 public:
  Pty() : near_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    EXPECT_EQ(::grantpt(near_.get()), 0);
    EXPECT_EQ(::unlockpt(near_.get()), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(::ptsname_r(near_.get(), name.data(), name.size()), 0);
    path_ = name.data();
  }

  const std::string& path() const { return path_; }
  int fd() const { return near_.get(); }
  void type(const std::string& text) const {
    EXPECT_EQ(::write(near_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  std::string screen() const {
    std::string text;
    std::array<char, 256> part{};
    for (ssize_t got = 0; (got = ::read(near_.get(), part.data(), part.size())) > 0;)
      text.append(part.data(), static_cast<std::size_t>(got));
    return text;
  }
  termios settings() const {
    termios result{};
    EXPECT_EQ(::tcgetattr(near_.get(), &result), 0);
    return result;
  }

 private:
  UniqueFd near_;
  std::string path_;
};

}  // namespace roomcal::drivers::test
