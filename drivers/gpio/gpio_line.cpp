#include "drivers/gpio/gpio_line.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <linux/gpio.h>

#include "drivers/gpio/gpio_chip.h"

namespace roomcal::drivers {

namespace {

constexpr char kConsumer[] = "roomcal";

uint64_t flags_of(const GpioLineOptions& options) {
  constexpr std::array<uint64_t, 4> kBias = {0, GPIO_V2_LINE_FLAG_BIAS_PULL_UP, GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN,
                                             GPIO_V2_LINE_FLAG_BIAS_DISABLED};
  const uint64_t active_low = options.active_low ? GPIO_V2_LINE_FLAG_ACTIVE_LOW : 0;
  return active_low | kBias[static_cast<std::size_t>(options.bias) % kBias.size()];
}

}  // namespace

Status GpioLine::request(const GpioLineOptions& options, uint64_t flags, uint32_t debounce_us, FileKernel& kernel) {
  release();
  kernel_ = &kernel;
  GpioPlace place;
  ROOMCAL_TRY(find_gpio_line(options, kernel, place));
  gpio_v2_line_request request{};
  request.offsets[0] = place.offset;
  request.num_lines = 1;
  std::memcpy(request.consumer, kConsumer, sizeof kConsumer);
  request.config.flags = flags | flags_of(options);
  if (debounce_us > 0) {
    request.config.num_attrs = 1;
    request.config.attrs[0].mask = 1;
    request.config.attrs[0].attr.id = GPIO_V2_LINE_ATTR_ID_DEBOUNCE;
    request.config.attrs[0].attr.debounce_period_us = debounce_us;
  }
  const int answer = kernel.ioctl(place.chip.get(), GPIO_V2_GET_LINE_IOCTL, &request);
  if (answer == -EBUSY) return {StatusCode::kUnavailable, "somebody else holds the GPIO line; gpioinfo shows who"};
  if (answer < 0)
    return {StatusCode::kUnavailable, "the GPIO chip cannot give the line as wanted; try it without bias"};
  fd_ = UniqueFd(request.fd);
  if (::fcntl(fd_.get(), F_SETFL, O_NONBLOCK) == 0) return ok_status();
  release();
  return {StatusCode::kUnavailable, "the GPIO line cannot be read without waiting"};
}

Status GpioLine::request_input(const GpioLineOptions& options, uint32_t debounce_us, FileKernel& kernel) {
  constexpr uint64_t kBothEdges = GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING;
  return request(options, GPIO_V2_LINE_FLAG_INPUT | kBothEdges, debounce_us, kernel);
}

Status GpioLine::request_output(const GpioLineOptions& options, FileKernel& kernel) {
  return request(options, GPIO_V2_LINE_FLAG_OUTPUT, 0, kernel);
}

bool GpioLine::get(bool& active) const {
  gpio_v2_line_values values{};
  values.mask = 1;
  if (!held() || kernel_->ioctl(fd(), GPIO_V2_LINE_GET_VALUES_IOCTL, &values) < 0) return false;
  active = (values.bits & 1) != 0;
  return true;
}

bool GpioLine::set(bool active) const {
  gpio_v2_line_values values{};
  values.mask = 1;
  values.bits = active ? 1 : 0;
  return held() && kernel_->ioctl(fd(), GPIO_V2_LINE_SET_VALUES_IOCTL, &values) >= 0;
}

}  // namespace roomcal::drivers
