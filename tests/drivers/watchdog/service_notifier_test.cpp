#include "drivers/watchdog/service_notifier.h"

#include <array>
#include <cstring>
#include <string>

#include "tests/drivers/folder_of_test.h"

namespace roomcal::drivers {
namespace {

/// A service manager: takes datagrams at a path or an abstract name.
class Manager {
 public:
  explicit Manager(const std::string& name) : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(name.begin(), name.end(), address.sun_path);
    if (name[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&address), size), 0) << std::strerror(errno);
  }
  std::string next() const {
    std::array<char, 512> text{};
    const ssize_t got = ::recv(fd_.get(), text.data(), text.size(), 0);
    return got < 0 ? "nothing" : std::string(text.data(), static_cast<std::size_t>(got));
  }

 private:
  UniqueFd fd_;
};

class ServiceNotifierTest : public test::FolderOfTest {
 protected:
  std::string path() const { return (folder_ / "notify").string(); }
  ServiceNotifier notifier_;
};

TEST_F(ServiceNotifierTest, EveryMessage_IsOneDatagram) {
  for (const std::string& name : {path(), std::string("@").append(path())}) {
    const Manager manager(name);
    ASSERT_TRUE(notifier_.start(name.c_str()).ok());
    EXPECT_TRUE(notifier_.active());
    notifier_.ready();
    notifier_.feed();
    notifier_.status("calibrating, 40 %");
    notifier_.stopping();
    for (const char* expected : {"READY=1", "WATCHDOG=1", "STATUS=calibrating, 40 %", "STOPPING=1", "nothing"})
      EXPECT_EQ(manager.next(), expected);
  }
}

TEST_F(ServiceNotifierTest, NoManager_DoesNothing) {
  for (const char* name : {static_cast<const char*>(nullptr), ""}) {
    ASSERT_TRUE(notifier_.start(name).ok());
    EXPECT_FALSE(notifier_.active());
    notifier_.ready();
    notifier_.feed();
    EXPECT_EQ(notifier_.unsent(), 0U);
  }
}

TEST_F(ServiceNotifierTest, StatusThatWouldSayMore_IsOneLine) {
  const Manager manager(path());
  ASSERT_TRUE(notifier_.start(path().c_str()).ok());
  notifier_.status("cam2\nWATCHDOG=1\r\t.");
  EXPECT_EQ(manager.next(), "STATUS=cam2 WATCHDOG=1  .");
  notifier_.status(std::string(1000, 'x'));
  EXPECT_EQ(manager.next(), std::string("STATUS=").append(200, 'x'));
}

TEST_F(ServiceNotifierTest, ManagerThatDoesNotRead_NeverHoldsUs) {
  const Manager manager(path());
  ASSERT_TRUE(notifier_.start(path().c_str()).ok());
  for (int i = 0; i < 100'000; ++i) notifier_.feed();
  EXPECT_GT(notifier_.unsent(), 0U);
  EXPECT_EQ(manager.next(), "WATCHDOG=1");
}

TEST_F(ServiceNotifierTest, ManagerThatComesBack_IsTold) {
  {
    const Manager first(path());
    ASSERT_TRUE(notifier_.start(path().c_str()).ok());
    notifier_.feed();
  }
  notifier_.feed();
  EXPECT_EQ(notifier_.unsent(), 1U);
  std::filesystem::remove(path());
  const Manager second(path());
  notifier_.feed();
  EXPECT_EQ(second.next(), "WATCHDOG=1");
}

TEST_F(ServiceNotifierTest, NobodyThere_IsSaid) {
  EXPECT_EQ(notifier_.start((path() + "-none").c_str()).code(), StatusCode::kUnavailable);
  EXPECT_EQ(notifier_.start("relative").code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(notifier_.start(std::string("/").append(200, 'x').c_str()).code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(notifier_.active());
}

TEST(ServiceWatchdog, Environment_TellsTheInterval) {
  EXPECT_EQ(service_watchdog_ns("5000000", nullptr, 42), 5'000'000'000);
  EXPECT_EQ(service_watchdog_ns("5000000", "42", 42), 5'000'000'000);
  EXPECT_EQ(service_watchdog_ns("5000000", "43", 42), 0);
  for (const char* text : {static_cast<const char*>(nullptr), "", "x", "5s", "-1", "0", "99999999999999999999"})
    EXPECT_EQ(service_watchdog_ns(text, nullptr, 42), 0) << (text == nullptr ? "absent" : text);
  EXPECT_EQ(service_watchdog_ns("5000000", "me", 42), 0);
}

}  // namespace
}  // namespace roomcal::drivers
