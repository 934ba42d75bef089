#include "drivers/can/signal.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace roomcal::drivers {

namespace {

uint64_t mask_of(const Signal& signal) { return (uint64_t{1} << signal.bits) - 1; }

// Calls visit(byte, shift in the byte, bits taken so far, bits of this byte) for every byte that the signal touches.
template <typename Visit>
void for_each_byte(const Signal& signal, const Visit& visit) {
  for (unsigned done = 0; done < signal.bits;) {
    const unsigned bit = signal.start_bit + done;
    const unsigned count = std::min(8 - bit % 8, signal.bits - done);
    visit(bit / 8, bit % 8, done, count);
    done += count;
  }
}

// In steps and not in the signal's unit: a value that was read from a message may lie a rounding error outside.
std::pair<double, double> step_limits(const Signal& signal) {
  return std::minmax({std::round((signal.minimum - signal.offset) / signal.factor),
                      std::round((signal.maximum - signal.offset) / signal.factor)});
}

}  // namespace

bool is_of(const MessageLayout& layout, const ports::CanMessage& message) {
  return message.id == layout.id && message.extended == layout.extended && message.length == layout.length;
}

ports::CanMessage blank(const MessageLayout& layout) {
  ports::CanMessage message;
  message.id = layout.id;
  message.extended = layout.extended;
  message.length = layout.length;
  return message;
}

int64_t raw_of(const Signal& signal, const ports::CanMessage& message) {
  uint64_t raw = 0;
  for_each_byte(signal, [&](unsigned byte, unsigned shift, unsigned done, unsigned count) {
    const uint64_t part = (message.data[byte] >> shift) & ((1U << count) - 1);
    raw |= part << done;
  });
  const bool negative = signal.is_signed && ((raw >> (signal.bits - 1)) & 1) != 0;
  return static_cast<int64_t>(negative ? raw | ~mask_of(signal) : raw);
}

double value_of(const Signal& signal, const ports::CanMessage& message) {
  return signal.factor * static_cast<double>(raw_of(signal, message)) + signal.offset;
}

void put_raw(const Signal& signal, int64_t raw, ports::CanMessage& message) {
  const auto bits = static_cast<uint64_t>(raw) & mask_of(signal);
  for_each_byte(signal, [&](unsigned byte, unsigned shift, unsigned done, unsigned count) {
    const unsigned mask = ((1U << count) - 1) << shift;
    const auto part = static_cast<unsigned>(bits >> done) << shift;
    message.data[byte] = static_cast<uint8_t>((message.data[byte] & ~mask) | (part & mask));
  });
}

Status put(const Signal& signal, double value, ports::CanMessage& message) {
  const double steps = std::round((value - signal.offset) / signal.factor);
  const auto [low, high] = step_limits(signal);
  // NaN fails both comparisons.
  if (!(steps >= low && steps <= high))
    return {StatusCode::kOutOfRange, "the value is beyond the limits of its CAN signal"};
  put_raw(signal, static_cast<int64_t>(steps), message);
  return ok_status();
}

void put_clamped(const Signal& signal, double value, ports::CanMessage& message) {
  const double within = std::isnan(value) ? signal.maximum : std::clamp(value, signal.minimum, signal.maximum);
  put_raw(signal, std::llround((within - signal.offset) / signal.factor), message);
}

const char* label_of(const Signal& signal, int64_t raw) {
  for (const Label& label : signal.labels)
    if (label.raw == raw) return label.text;
  return nullptr;
}

}  // namespace roomcal::drivers
