#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

namespace roomcal::drivers::test {

/// While it lives, the process is somebody without rights, if it was the superuser before.
class AsNobody {
 public:
  AsNobody() : user_(::geteuid()) {
    if (user_ == 0) {
      EXPECT_EQ(::seteuid(65534), 0);
    }
  }
  ~AsNobody() { EXPECT_EQ(::seteuid(user_), 0); }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  uid_t user_;
};

}  // namespace roomcal::drivers::test
