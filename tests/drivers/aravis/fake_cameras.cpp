#include "tests/drivers/aravis/fake_cameras.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "drivers/gige/control_probe.h"
#include "drivers/gige/gvcp.h"
#include "drivers/gige/ipv4.h"
#include "drivers/os/linux_clocks.h"
#include "drivers/os/unique_fd.h"

namespace roomcal::drivers {

namespace {

ifreq request_for(const char* interface) {
  ifreq request{};
  std::strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
  return request;
}

bool set_address(int socket, const char* interface, const char* address) {
  ifreq request = request_for(interface);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  ::inet_pton(AF_INET, address, &at.sin_addr);
  std::memcpy(&request.ifr_addr, &at, sizeof at);
  return ::ioctl(socket, SIOCSIFADDR, &request) == 0;
}

bool set_up(int socket, const char* interface) {
  ifreq request = request_for(interface);
  if (::ioctl(socket, SIOCGIFFLAGS, &request) != 0) return false;
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
  return ::ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

std::string make_network() {
  const int what = ::geteuid() == 0 ? CLONE_NEWNET : CLONE_NEWUSER | CLONE_NEWNET;
  if (::unshare(what) != 0)
    return std::string("no right to a network of its own (unshare -n): ") + std::strerror(errno);
  const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM, 0));
  if (!set_up(socket.get(), "lo") || !set_address(socket.get(), "lo:1", "127.0.0.2"))
    return std::string("its network takes no second loopback address: ") + std::strerror(errno);
  return "";
}

}  // namespace

std::string enter_own_network() {
  static const std::string why = make_network();
  return why;
}

std::string why_no_fake_cameras() {
  return ::access("/usr/bin/arv-fake-gv-camera-0.8", X_OK) == 0
             ? ""
             : "arv-fake-gv-camera-0.8 is not installed (apt-get install aravis-tools)";
}

void FakeGigeCamera::wait_until_it_answers() const {
  const auto at = ipv4_endpoint(options_.address, gvcp::kPort);
  for (int i = 0; i < 200; ++i)
    if (probe_control(*at, LinuxClocks(), 1, 20'000'000) != ControlState::kAbsent) return;
  throw std::runtime_error("a fake camera does not answer");
}

void FakeGigeCamera::start() {
  std::vector<std::string> words{"arv-fake-gv-camera-0.8",
                                 "-i",
                                 options_.address,
                                 "-s",
                                 options_.serial,
                                 "-r",
                                 std::to_string(options_.lost_per_thousand)};
  if (!options_.genicam_file.empty()) words.insert(words.end(), {"-g", options_.genicam_file});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("no process for a fake camera");
  if (pid_ > 0) return wait_until_it_answers();
  // Between fork and exec only what is safe with threads about.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // A camera does not wait for the host's load; without the right to it this one does.
  const sched_param priority{20};
  ::sched_setscheduler(0, SCHED_FIFO, &priority);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  ::execvp(arguments[0], arguments.data());
  ::_exit(127);
}

void FakeGigeCamera::kill() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

void FakeGigeCamera::hang(bool on) { ::kill(pid_, on ? SIGSTOP : SIGCONT); }

}  // namespace roomcal::drivers
