#include "drivers/can/socketcan.h"

#include <cerrno>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include "tests/fakes/fake_can_kernel.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using fakes::CanCall;
using ports::CanState;

constexpr int64_t kMs = 1'000'000;

canfd_frame frame_of(canid_t id, uint8_t first_byte = 0, uint8_t length = 2) {
  canfd_frame frame{};
  frame.can_id = id;
  frame.len = length;
  frame.data[0] = first_byte;
  return frame;
}

struct SocketCanTest : testing::Test {
  Status start() { return bus.start({"can0", ids}); }
  std::vector<ports::CanMessage> drain() {
    std::vector<ports::CanMessage> all;
    for (ports::CanMessage message; bus.receive(message);) all.push_back(message);
    return all;
  }
  ports::CanMessage message_of(uint32_t id, uint8_t length = 2, bool extended = false) const {
    ports::CanMessage message;
    message.id = id;
    message.length = length;
    message.extended = extended;
    return message;
  }

  std::vector<CanId> ids{{0x123, false}, {0x80, false}, {0x12345, true}};
  fakes::FakeCanKernel kernel;
  fakes::ManualClocks clocks;
  SocketCan bus{kernel, clocks};
};

TEST_F(SocketCanTest, Filters_PassDataMessagesOfExactlyTheseIdentifiers) {
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(bus.state(), CanState::kActive);
  for (const canid_t id : {0x123U, 0x124U, 0x123U | CAN_EFF_FLAG, 0x123U | CAN_RTR_FLAG, 0x12345U | CAN_EFF_FLAG,
                           0x12345U | CAN_EFF_FLAG | CAN_RTR_FLAG, 0x345U, 0x80U})
    kernel.arrive(frame_of(id));
  const auto got = drain();
  ASSERT_EQ(got.size(), 3U);
  EXPECT_EQ(got[0].id, 0x123U);
  EXPECT_FALSE(got[0].extended);
  EXPECT_EQ(got[1].id, 0x12345U);
  EXPECT_TRUE(got[1].extended);
  EXPECT_EQ(got[2].id, 0x80U);
  EXPECT_EQ(bus.counters().received, 3U);
}

TEST_F(SocketCanTest, OwnMessage_ComesBackWithTheStampOfTheBus) {
  ASSERT_TRUE(start().ok());
  kernel.stamp_ns = 1'700'000'000'123'456'789;
  ASSERT_TRUE(bus.send(message_of(0x80, 0)).ok());
  const auto got = drain();
  ASSERT_EQ(got.size(), 1U);
  EXPECT_TRUE(got[0].own);
  EXPECT_EQ(got[0].stamp, (Stamp{1'700'000'000'123'456'789, ClockId::kRealtime}));
  EXPECT_EQ(bus.counters().sent, 1U);
  EXPECT_EQ(bus.counters().received, 0U);
  kernel.stamps = false;
  kernel.arrive(frame_of(0x123));
  EXPECT_EQ(drain()[0].stamp.clock, ClockId::kUnknown) << "a stamp that is not there is not made up";
}

TEST_F(SocketCanTest, CanFd_WhereTheMtuSaysSo) {
  ASSERT_TRUE(start().ok());
  EXPECT_FALSE(bus.carries_fd());
  EXPECT_EQ(bus.send(message_of(0x123, 12)).code(), StatusCode::kInvalidArgument);
  kernel.mtu = CANFD_MTU;
  ASSERT_TRUE(start().ok());
  EXPECT_TRUE(bus.carries_fd());
  ports::CanMessage longest = message_of(0x123, 64);
  longest.data[63] = 77;
  ASSERT_TRUE(bus.send(longest).ok());
  EXPECT_EQ(kernel.last_sent_bytes(), CANFD_MTU);
  const auto got = drain();
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].length, 64);
  EXPECT_EQ(got[0].data, longest.data);
  ASSERT_TRUE(bus.send(message_of(0x123, 8)).ok());
  EXPECT_EQ(kernel.last_sent_bytes(), CAN_MTU) << "what fits into a classic message is one";
}

TEST_F(SocketCanTest, KernelWithoutCanFd_CarriesClassicMessages) {
  kernel.mtu = CANFD_MTU;
  kernel.set_script({CanCall::kSetOption, 5, 1, ENOPROTOOPT});
  ASSERT_TRUE(start().ok());
  EXPECT_FALSE(bus.carries_fd());
}

TEST_F(SocketCanTest, WhatCannotBeAMessage_IsRefused) {
  kernel.mtu = CANFD_MTU;
  ASSERT_TRUE(start().ok());
  EXPECT_EQ(bus.send(message_of(0x800)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(bus.send(message_of(0x20000000, 2, true)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(bus.send(message_of(0x123, 9)).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(bus.counters().send_refused, 3U);
  EXPECT_TRUE(bus.send(message_of(0x1FFFFFFF, 0, true)).ok());
}

TEST_F(SocketCanTest, BadOptions_AreRefused) {
  EXPECT_EQ(bus.start({"", ids}).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(bus.start({"can-of-16-bytes!", ids}).code(), StatusCode::kInvalidArgument);
  ids.assign(kMaxCanIds + 1, {1, false});
  EXPECT_EQ(start().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(kernel.open_sockets(), 0);
}

TEST_F(SocketCanTest, FullQueue_IsWaitedForAndThenRefused) {
  ASSERT_TRUE(start().ok());
  kernel.set_script({CanCall::kSend, 0, 3, ENOBUFS});
  EXPECT_TRUE(bus.send(message_of(0x123)).ok());
  EXPECT_EQ(clocks.sleeps(), 3);
  kernel.set_script({CanCall::kSend, 0, 1000, ENOBUFS});
  const int64_t before_ns = clocks.now_ns();
  const Status refused = bus.send(message_of(0x123));
  EXPECT_EQ(refused.code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(refused.detail()).find("queue"), std::string::npos);
  EXPECT_EQ(bus.error_number(), ENOBUFS);
  EXPECT_LE(clocks.now_ns() - before_ns, 2 * kMs);
  EXPECT_EQ(bus.counters().send_refused, 1U);
  EXPECT_EQ(bus.state(), CanState::kActive);
}

TEST_F(SocketCanTest, UnpluggedAndPluggedIn_IsFoundByItsName) {
  ASSERT_TRUE(start().ok());
  kernel.arrive(frame_of(0x123, 1));
  kernel.unplug();
  EXPECT_TRUE(drain().empty()) << "what waited in the old socket is thrown away";
  EXPECT_EQ(bus.state(), CanState::kDown);
  EXPECT_EQ(bus.error_number(), ENODEV);
  EXPECT_EQ(bus.send(message_of(0x123)).code(), StatusCode::kUnavailable);
  for (int i = 0; i < 100; ++i, clocks.advance(10 * kMs)) drain();
  EXPECT_LE(kernel.calls(CanCall::kIndex), 12) << "looked for ten times a second";
  EXPECT_NE(std::string(bus.trouble().detail()).find("name"), std::string::npos);
  kernel.plug();
  for (int i = 0; i < 11; ++i, clocks.advance(10 * kMs)) drain();
  EXPECT_EQ(bus.state(), CanState::kActive);
  EXPECT_TRUE(bus.trouble().ok());
  kernel.arrive(frame_of(0x123, 2));
  ASSERT_EQ(drain().size(), 1U);
  EXPECT_EQ(kernel.open_sockets(), 1);
}

TEST_F(SocketCanTest, InterfaceThatComesLater_IsWaitedFor) {
  kernel.unplug();
  EXPECT_EQ(start().code(), StatusCode::kUnavailable);
  kernel.plug();
  clocks.advance(100 * kMs);
  drain();
  EXPECT_EQ(bus.state(), CanState::kActive);
}

TEST_F(SocketCanTest, DownAndUp_IsNoticedBySendToo) {
  ASSERT_TRUE(start().ok());
  kernel.set_up(false);
  EXPECT_EQ(bus.send(message_of(0x123)).code(), StatusCode::kUnavailable);
  EXPECT_EQ(bus.state(), CanState::kDown);
  clocks.advance(100 * kMs);
  drain();
  EXPECT_EQ(bus.state(), CanState::kDown);
  EXPECT_EQ(bus.error_number(), ENETDOWN);
  kernel.set_up(true);
  clocks.advance(100 * kMs);
  drain();
  EXPECT_EQ(bus.state(), CanState::kActive);
}

TEST_F(SocketCanTest, ErrorMessages_TellTheState) {
  ASSERT_TRUE(start().ok());
  const auto after = [&](uint32_t classes, uint8_t control) {
    kernel.arrive_error(classes, control);
    EXPECT_TRUE(drain().empty());
    return bus.state();
  };
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING), CanState::kWarning);
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_PASSIVE), CanState::kPassive);
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW), CanState::kPassive) << "says nothing of the state";
  EXPECT_EQ(bus.counters().kernel_drops, 1U);
  EXPECT_EQ(after(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE), CanState::kActive);
  EXPECT_EQ(after(CAN_ERR_BUSOFF, 0), CanState::kBusOff);
  EXPECT_EQ(after(CAN_ERR_BUSOFF, 0), CanState::kBusOff);
  EXPECT_EQ(bus.counters().bus_offs, 1U);
  EXPECT_EQ(after(CAN_ERR_RESTARTED, 0), CanState::kActive);
  EXPECT_EQ(bus.counters().error_messages, 7U);
}

TEST_F(SocketCanTest, BusOff_RefusesUntilRestartedOrTriedAgain) {
  ASSERT_TRUE(start().ok());
  kernel.arrive_error(CAN_ERR_BUSOFF);
  drain();
  EXPECT_EQ(bus.send(message_of(0x123)).code(), StatusCode::kUnavailable);
  EXPECT_EQ(kernel.calls(CanCall::kSend), 0);
  // The word of the restart is lost. A message of somebody else tells, and so does one that goes out.
  kernel.arrive(frame_of(0x123));
  EXPECT_EQ(drain().size(), 1U);
  EXPECT_EQ(bus.state(), CanState::kActive);
  kernel.arrive_error(CAN_ERR_BUSOFF);
  drain();
  clocks.advance(1'000 * kMs);
  kernel.confirms = false;
  EXPECT_TRUE(bus.send(message_of(0x123)).ok());
  EXPECT_FALSE(bus.send(message_of(0x123)).ok()) << "one try a second";
  kernel.confirms = true;
  clocks.advance(1'000 * kMs);
  EXPECT_TRUE(bus.send(message_of(0x123)).ok());
  EXPECT_EQ(drain().size(), 1U);
  EXPECT_EQ(bus.state(), CanState::kActive);
}

TEST_F(SocketCanTest, Losses_AreCountedOnceHoweverTheyAreTold) {
  ASSERT_TRUE(start().ok());
  constexpr std::size_t kRoom = fakes::FakeCanKernel::kQueue;
  for (std::size_t i = 0; i < kRoom + 10; ++i) kernel.arrive(frame_of(0x123));
  EXPECT_EQ(drain().size(), kRoom);
  EXPECT_EQ(bus.counters().kernel_drops, 10U) << "then silence: only asking tells";
  // SO_RXQ_OVFL with the messages that come after a loss, while asking fails.
  kernel.set_script({CanCall::kGetOption, 0, 1000, ENOPROTOOPT});
  for (std::size_t i = 0; i < kRoom + 5; ++i) kernel.arrive(frame_of(0x123));
  drain();
  EXPECT_EQ(bus.counters().kernel_drops, 10U);
  kernel.arrive(frame_of(0x123));
  drain();
  EXPECT_EQ(bus.counters().kernel_drops, 15U);
  // Another socket counts from zero.
  kernel.set_script({});
  kernel.unplug();
  drain();
  kernel.plug();
  clocks.advance(100 * kMs);
  drain();
  for (std::size_t i = 0; i < kRoom + 2; ++i) kernel.arrive(frame_of(0x123));
  drain();
  EXPECT_EQ(bus.counters().kernel_drops, 17U);
}

TEST_F(SocketCanTest, RubbishFromTheKernel_IsNoMessage) {
  kernel.mtu = CANFD_MTU;
  ASSERT_TRUE(start().ok());
  for (std::size_t bytes = 0; bytes <= 200; ++bytes)
    if (bytes != CAN_MTU && bytes != CANFD_MTU) kernel.arrive(frame_of(0x123), bytes);
  kernel.arrive(frame_of(0x123, 0, 9), CAN_MTU);
  kernel.arrive(frame_of(0x123, 0, 65), CANFD_MTU);
  EXPECT_TRUE(drain().empty());
  kernel.arrive(frame_of(0x123));
  EXPECT_EQ(drain().size(), 1U);
}

TEST_F(SocketCanTest, EveryErrnoAtEveryCall_EndsInAnErrorOrNothingAndHeals) {
  constexpr std::array kErrors{
      EPERM,           ENOENT,     EINTR,        EIO,        ENXIO,         EBADF,    EAGAIN,
      ENOMEM,          EACCES,     EFAULT,       EBUSY,      ENODEV,        EINVAL,   ENFILE,
      EMFILE,          ENOSPC,     EPIPE,        EPROTO,     ENOTSOCK,      EMSGSIZE, ENOPROTOOPT,
      EPROTONOSUPPORT, EOPNOTSUPP, EAFNOSUPPORT, EADDRINUSE, EADDRNOTAVAIL, ENETDOWN, ENETUNREACH,
      ENETRESET,       ECONNRESET, ENOBUFS,      ETIMEDOUT,  ECOMM,         ENOTTY};
  int cases = 0;
  for (int call = 0; call < static_cast<int>(CanCall::kCount); ++call)
    for (const int error : kErrors)
      for (const int at : {0, 1, 2, 3, 4})
        for (const int times : {1, 40}) {
          SCOPED_TRACE("call " + std::to_string(call) + " errno " + std::to_string(error) + " at " +
                       std::to_string(at));
          fakes::FakeCanKernel fresh;
          SocketCan one(fresh, clocks);
          fresh.set_script({static_cast<CanCall>(call), at, times, error});
          const bool started = one.start({"can0", ids}).ok();
          ASSERT_EQ(started, one.state() == CanState::kActive);
          for (int turn = 0; turn < 20; ++turn, clocks.advance(50 * kMs)) {
            fresh.arrive(frame_of(0x123));
            ports::CanMessage message;
            const int64_t before_ns = clocks.now_ns();
            const bool sent = one.send(message_of(0x80)).ok();
            ASSERT_LE(clocks.now_ns() - before_ns, 2 * kMs);
            ASSERT_TRUE(sent || one.error_number() != 0 || one.state() == CanState::kDown);
            for (int taken = 0; taken < 100 && one.receive(message); ++taken)
              ASSERT_TRUE(message.id == 0x123 || (message.id == 0x80 && message.own));
            ASSERT_LE(fresh.open_sockets(), 1);
          }
          fresh.set_script({});
          clocks.advance(100 * kMs);
          ports::CanMessage message;
          while (one.receive(message)) {
          }
          ASSERT_EQ(one.state(), CanState::kActive);
          ASSERT_TRUE(one.send(message_of(0x80)).ok());
          ASSERT_TRUE(one.receive(message));
          ASSERT_TRUE(message.own);
          ++cases;
        }
  std::printf("%d cases\n", cases);
}

TEST_F(SocketCanTest, FloodOfErrors_DoesNotHoldTheLoop) {
  // A controller that reports faster than we read.
  struct Flood final : CanKernel {
    int open_raw() override { return 3; }
    void close(int) override {}
    int interface_index(int, const char*) override { return 1; }
    int interface_flags(int, const char*) override { return 1; }
    int interface_mtu(int, const char*) override { return CAN_MTU; }
    int set_option(int, int, int, const void*, std::size_t) override { return 0; }
    int get_option(int, int, int, void*, std::size_t) override { return 0; }
    int bind_to(int, int) override { return 0; }
    long send(int, const void*, std::size_t bytes) override { return static_cast<long>(bytes); }
    long receive(int, msghdr& into) override {
      canfd_frame frame{};
      frame.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL;
      std::copy_n(reinterpret_cast<const char*>(&frame), CAN_MTU, static_cast<char*>(into.msg_iov[0].iov_base));
      into.msg_controllen = 0;
      return CAN_MTU;
    }
  } flood;
  SocketCan one(flood, clocks);
  ASSERT_TRUE(one.start({"can0", ids}).ok());
  ports::CanMessage message;
  EXPECT_FALSE(one.receive(message));
  EXPECT_EQ(one.state(), CanState::kDown);
  EXPECT_NE(std::string(one.trouble().detail()).find("floods"), std::string::npos);
}

TEST_F(SocketCanTest, MissingCan_NamesTheModules) {
  kernel.set_script({CanCall::kOpen, 0, 1, EAFNOSUPPORT});
  EXPECT_NE(std::string(start().detail()).find("load its modules can and can_raw"), std::string::npos);
  EXPECT_FALSE(bus.send(message_of(0x123)).ok());
  EXPECT_NE(std::string(bus.trouble().detail()).find("modules"), std::string::npos) << "still the reason";
}

TEST_F(SocketCanTest, BeforeItsStart_NothingIsSentOrHeard) {
  EXPECT_EQ(bus.send(message_of(0x123)).code(), StatusCode::kUnavailable);
  EXPECT_TRUE(drain().empty());
  EXPECT_EQ(kernel.calls(CanCall::kOpen), 0);
}

TEST(LinuxCanKernel, HostWithoutTheInterface_IsAnErrorNotACrash) {
  LinuxCanKernel kernel;
  fakes::ManualClocks clocks;
  SocketCan bus(kernel, clocks);
  const std::array<CanId, 1> ids{{{1, false}}};
  const Status started = bus.start({"nocan77", ids});
  EXPECT_EQ(started.code(), StatusCode::kUnavailable);
  EXPECT_NE(bus.error_number(), 0);
}

}  // namespace
}  // namespace roomcal::drivers
