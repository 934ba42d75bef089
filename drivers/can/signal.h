#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/status.h"
#include "runtime/ports/can_bus.h"

namespace roomcal::drivers {

/// A word for one raw value of a signal.
struct Label {
  int64_t raw = 0;
  const char* text = "";
};

/// Where a number lies in a message, Intel byte order: bit i of the message is bit i % 8 of byte i / 8.
///   value = factor * raw + offset
struct Signal {
  const char* name = "";
  uint16_t start_bit = 0;
  uint8_t bits = 1;  ///< 1 to 52: a double holds every raw value
  bool is_signed = false;
  double factor = 1, offset = 0;
  double minimum = 0, maximum = 0;  ///< of the value; raw values outside may have a label
  const char* unit = "";
  std::span<const Label> labels;
};

/// A message of a DBC file; dbcgen.py makes them.
struct MessageLayout {
  const char* name = "";
  uint32_t id = 0;
  bool extended = false;
  uint8_t length = 0;
  uint16_t data_id = 0;   ///< of E2E profile 11 (protection.h); 0: not protected
  uint16_t cycle_ms = 0;  ///< 0: sent when there is a reason
  std::span<const Signal> signals;
};

/// Whether the message is one of this layout: identifier and length.
bool is_of(const MessageLayout& layout, const ports::CanMessage& message);

/// A message of this layout with all bits zero.
ports::CanMessage blank(const MessageLayout& layout);

/// The bits of a signal as a number. Bits beyond the message's length read as they are in `data`.
int64_t raw_of(const Signal& signal, const ports::CanMessage& message);
double value_of(const Signal& signal, const ports::CanMessage& message);

/// Puts the step nearest to `value` into the message.
/// @return kOutOfRange for a value that is not a number or rounds to beyond the signal's limits; the message is then
///         unchanged.
Status put(const Signal& signal, double value, ports::CanMessage& message);

/// Puts a value that is brought within the signal's limits first; NaN becomes the maximum.
void put_clamped(const Signal& signal, double value, ports::CanMessage& message);

/// Puts a labelled value. @pre `raw` fits the signal's bits: it comes from the same table.
void put_raw(const Signal& signal, int64_t raw, ports::CanMessage& message);
template <typename Enum>
void put_label(const Signal& signal, Enum label, ports::CanMessage& message) {
  put_raw(signal, static_cast<int64_t>(label), message);
}

/// The word for a raw value. @return nullptr if the table has none.
const char* label_of(const Signal& signal, int64_t raw);

}  // namespace roomcal::drivers
