#include "drivers/gpio/gpio_chip.h"

#include <array>
#include <charconv>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <linux/gpio.h>

#include "drivers/os/c_text.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

constexpr int kMaxChips = 64;

template <std::size_t kSize>
std::string_view text_of(const char (&chars)[kSize]) {
  return {chars, ::strnlen(chars, kSize)};
}

bool number_of(std::string_view text, uint32_t& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

/// A name wins over a number: lines may be called "7".
bool line_of(int chip, uint32_t lines, const GpioLineOptions& options, FileKernel& kernel, uint32_t& offset) {
  for (uint32_t i = 0; i < lines; ++i) {
    gpio_v2_line_info info{};
    info.offset = i;
    if (kernel.ioctl(chip, GPIO_V2_GET_LINEINFO_IOCTL, &info) < 0) continue;
    if (text_of(info.name) != options.line.view()) continue;
    offset = i;
    return true;
  }
  return !options.chip.empty() && number_of(options.line.view(), offset) && offset < lines;
}

bool look_at(const char* path, bool by_label, const GpioLineOptions& options, FileKernel& kernel, GpioPlace& place) {
  UniqueFd chip(kernel.open(path, O_RDWR));
  gpiochip_info info{};
  if (!chip.valid() || kernel.ioctl(chip.get(), GPIO_GET_CHIPINFO_IOCTL, &info) < 0) return false;
  if (by_label && text_of(info.label) != options.chip.view()) return false;
  if (!line_of(chip.get(), info.lines, options, kernel, place.offset)) return false;
  place.chip = std::move(chip);
  return true;
}

}  // namespace

Status find_gpio_line(const GpioLineOptions& options, FileKernel& kernel, GpioPlace& place) {
  uint32_t number = 0;
  if (options.line.empty() || (options.chip.empty() && number_of(options.line.view(), number)))
    return {StatusCode::kInvalidArgument, "a GPIO line needs its name, or its number and its chip; see gpioinfo"};
  constexpr Status kNone(StatusCode::kNotFound, "no GPIO chip has the line; see gpioinfo for names and permissions");
  if (options.chip.view().starts_with('/'))
    return look_at(CText(options.chip).c_str(), false, options, kernel, place) ? ok_status() : kNone;
  for (int chip = 0; chip < kMaxChips; ++chip) {
    std::array<char, 32> path{};
    TextWriter({path.data(), path.size() - 1}).text("/dev/gpiochip").integer(chip);
    if (look_at(path.data(), !options.chip.empty(), options, kernel, place)) return ok_status();
  }
  return kNone;
}

}  // namespace roomcal::drivers
