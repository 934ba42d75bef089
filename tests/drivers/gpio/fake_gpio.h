#pragma once

#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <linux/gpio.h>
#include <sys/socket.h>

#include "drivers/os/unique_fd.h"
#include "tests/fakes/fake_file_kernel.h"

namespace roomcal::drivers::test {

/// GPIO chips as the kernel shows them: information, requests, values, edges.
class FakeGpio {
 public:
  struct Line {
    std::string name;
    bool busy = false;  ///< somebody else holds it
    bool active = false;
    gpio_v2_line_config config{};  ///< as requested last
    std::vector<bool> written;     ///< by us
    UniqueFd events;
    uint32_t edges = 0;
  };
  struct Chip {
    std::string label;
    std::vector<Line> lines;
  };

  explicit FakeGpio(fakes::FakeFileKernel& kernel) {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    spare_ = {UniqueFd(ends[0]), UniqueFd(ends[1])};
    kernel.on_open = [this](const char* path, int) { return open(path); };
    kernel.on_ioctl = [this](int fd, unsigned long request, void* argument) { return answer(fd, request, argument); };
  }

  std::map<std::string, Chip> chips;  ///< by path

  void add(const std::string& path, const std::string& label, const std::vector<std::string>& names) {
    Chip& chip = chips[path];
    chip.label = label;
    for (const std::string& name : names) chip.lines.emplace_back().name = name;
  }
  /// The level changes; the kernel tells whoever holds the line.
  static void change(Line& line, bool active, int64_t stamp_ns) {
    line.active = active;
    gpio_v2_line_event event{};
    event.timestamp_ns = static_cast<uint64_t>(stamp_ns);
    event.id = active ? GPIO_V2_LINE_EVENT_RISING_EDGE : GPIO_V2_LINE_EVENT_FALLING_EDGE;
    event.line_seqno = ++line.edges;
    static_cast<void>(::send(line.events.get(), &event, sizeof event, MSG_NOSIGNAL));
  }
  static void unplug(Line& line) { line.events.reset(); }

 private:
  int open(const char* path) {
    const auto chip = chips.find(path);
    if (chip == chips.end()) return -ENOENT;
    const int fd = fakes::FakeFileKernel::share(spare_[0].get());
    chip_of_[fd] = &chip->second;
    line_of_.erase(fd);
    return fd;
  }

  int answer(int fd, unsigned long request, void* argument) {
    if (const auto line = line_of_.find(fd); line != line_of_.end()) return of_line(*line->second, request, argument);
    const auto chip = chip_of_.find(fd);
    return chip == chip_of_.end() ? -EBADF : of_chip(*chip->second, request, argument);
  }

  int of_chip(Chip& chip, unsigned long request, void* argument) {
    if (request == GPIO_GET_CHIPINFO_IOCTL) {
      auto& info = *static_cast<gpiochip_info*>(argument);
      chip.label.copy(info.label, sizeof info.label - 1);
      info.lines = static_cast<uint32_t>(chip.lines.size());
      return 0;
    }
    if (request == GPIO_V2_GET_LINEINFO_IOCTL) {
      auto& info = *static_cast<gpio_v2_line_info*>(argument);
      if (info.offset >= chip.lines.size()) return -EINVAL;
      chip.lines[info.offset].name.copy(info.name, sizeof info.name - 1);
      return 0;
    }
    if (request != GPIO_V2_GET_LINE_IOCTL) return -ENOTTY;
    auto& wanted = *static_cast<gpio_v2_line_request*>(argument);
    if (wanted.num_lines != 1 || wanted.offsets[0] >= chip.lines.size()) return -EINVAL;
    return hold(chip.lines[wanted.offsets[0]], wanted);
  }

  int hold(Line& line, gpio_v2_line_request& wanted) {
    if (line.busy) return -EBUSY;
    int ends[2] = {-1, -1};
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) return -errno;
    line.events = UniqueFd(ends[0]);
    line.config = wanted.config;
    wanted.fd = ends[1];
    line_of_[ends[1]] = &line;
    chip_of_.erase(ends[1]);
    return 0;
  }

  static int of_line(Line& line, unsigned long request, void* argument) {
    auto& values = *static_cast<gpio_v2_line_values*>(argument);
    if (request == GPIO_V2_LINE_GET_VALUES_IOCTL) {
      values.bits = line.active ? 1 : 0;
      return 0;
    }
    if (request != GPIO_V2_LINE_SET_VALUES_IOCTL) return -ENOTTY;
    if ((line.config.flags & GPIO_V2_LINE_FLAG_OUTPUT) == 0) return -EPERM;
    line.active = (values.bits & 1) != 0;
    line.written.push_back(line.active);
    return 0;
  }

  std::array<UniqueFd, 2> spare_;
  std::map<int, Chip*> chip_of_;
  std::map<int, Line*> line_of_;
};

}  // namespace roomcal::drivers::test
