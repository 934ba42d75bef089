// "-": the console on standard input and output, as somebody tries it by hand or from a script.

#include <array>
#include <csignal>
#include <string>

#include "drivers/serial/serial_port.h"
#include "tests/drivers/serial/pty.h"
#include "tests/fakes/manual_clocks.h"

namespace roomcal::drivers {
namespace {

using test::Pty;

// While it lives, standard input and output are the test's.
class Redirected {
 public:
  Redirected(int in, int out) : in_(::dup(0)), out_(::dup(1)) {
    EXPECT_EQ(::dup2(in, 0), 0);
    EXPECT_EQ(::dup2(out, 1), 1);
  }
  ~Redirected() {
    ::dup2(in_.get(), 0);
    ::dup2(out_.get(), 1);
  }

 private:
  UniqueFd in_, out_;
};

struct Pipe {
  Pipe() {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    out = UniqueFd(ends[0]);
    in = UniqueFd(ends[1]);
  }
  UniqueFd out, in;
};

class StandardLine : public testing::Test {
 protected:
  std::string read() {
    std::array<char, 64> bytes{};
    return {bytes.data(), port_.read_some(bytes)};
  }
  LinuxFileKernel kernel_;
  fakes::ManualClocks clocks_;
  SerialPort port_{{"-"}, kernel_, clocks_};
};

TEST_F(StandardLine, Terminal_IsRawWhileUsedAndGivenBack) {
  const Pty pty;
  const UniqueFd far(::open(pty.path().c_str(), O_RDWR | O_NOCTTY));
  const tcflag_t local_before = pty.settings().c_lflag, out_before = pty.settings().c_oflag;
  ASSERT_NE(local_before & (ICANON | ECHO), 0U);
  {
    const Redirected redirected(far.get(), far.get());
    ASSERT_TRUE(port_.start().ok());
    EXPECT_EQ(pty.settings().c_lflag & (ICANON | ECHO), 0U);
    EXPECT_NE(pty.settings().c_lflag & ISIG, 0U) << "Ctrl-C still interrupts";
    pty.type("help");
    EXPECT_EQ(read(), "help");
    EXPECT_EQ(port_.write_some(std::string_view("\r\nok")), 4U);
    EXPECT_EQ(pty.screen(), "\r\nok");
    EXPECT_EQ(::fcntl(far.get(), F_GETFL) & O_NONBLOCK, 0) << "the shell's own descriptors are left alone";
    port_.stop();
  }
  EXPECT_EQ(pty.settings().c_lflag, local_before);
  EXPECT_EQ(pty.settings().c_oflag, out_before);
}

TEST_F(StandardLine, Pipes_WorkUntilTheInputEnds) {
  Pipe input, output;
  const Redirected redirected(input.out.get(), output.in.get());
  ASSERT_TRUE(port_.start().ok());
  EXPECT_EQ(read(), "");
  ASSERT_EQ(::write(input.in.get(), "status\r", 7), 7);
  EXPECT_EQ(read(), "status\r");
  input.in.reset();
  EXPECT_EQ(read(), "");
  EXPECT_EQ(port_.fd(), -1);
  clocks_.advance(10 * Retry::kPeriod_ns);
  EXPECT_EQ(read(), "") << "an end is an end";
  EXPECT_EQ(port_.write_some(std::string_view("bye")), 3U) << "answers still leave";
  std::array<char, 8> bytes{};
  EXPECT_EQ(::read(output.out.get(), bytes.data(), bytes.size()), 3);
}

TEST_F(StandardLine, ReaderThatHasGone_IsNoHarm) {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  {
    Pipe input, output;
    const Redirected redirected(input.out.get(), output.in.get());
    ASSERT_TRUE(port_.start().ok());
    output.out.reset();
    for (int i = 0; i < 3; ++i) EXPECT_EQ(port_.write_some(std::string_view("x")), 0U);
    EXPECT_EQ(port_.times_lost(), 1U);
  }
  std::signal(SIGPIPE, before);
}

}  // namespace
}  // namespace roomcal::drivers
