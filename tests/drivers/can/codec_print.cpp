// Packs and unpacks every signal of the DBC files and prints what it did, for codec_test.py to decode by itself.
//   pack MESSAGE HEX SIGNAL=VALUE ...      values that were put, and the bytes that came of them
//   unpack MESSAGE HEX SIGNAL=RAW,VALUE ...  random bytes, and what was read from them

#include <cinttypes>
#include <cstdio>
#include <random>
#include <vector>

#include "drivers/can/protection.h"
#include "drivers/can/roomcal_dbc_generated.h"
#include "tests/drivers/can/codec_cases_generated.h"

namespace roomcal::drivers {
namespace {

constexpr int kRandomRounds = 200;

void print_bytes(const char* what, const MessageLayout& layout, const ports::CanMessage& message) {
  std::printf("%s %s %u %d ", what, layout.name, message.id, message.extended ? 1 : 0);
  for (const uint8_t byte : message.bytes()) std::printf("%02x", byte);
}

using Chooser = double (*)(const Signal&, std::mt19937_64&);
double at_minimum(const Signal& signal, std::mt19937_64&) { return signal.minimum; }
double at_maximum(const Signal& signal, std::mt19937_64&) { return signal.maximum; }
double anywhere(const Signal& signal, std::mt19937_64& random) {
  return std::uniform_real_distribution<double>(signal.minimum, signal.maximum)(random);
}

bool print_packed(const MessageLayout& layout, Chooser choose, std::mt19937_64& random) {
  ports::CanMessage message = blank(layout);
  for (std::size_t i = 0; i < layout.length; ++i) message.data[i] = static_cast<uint8_t>(random());
  std::vector<double> values;
  for (const Signal& signal : layout.signals) {
    values.push_back(choose(signal, random));
    if (!put(signal, values.back(), message).ok()) return false;
  }
  if (layout.data_id != 0) protect(layout, static_cast<uint8_t>(random() % kCounterSteps), message);
  print_bytes(layout.data_id != 0 ? "protected" : "pack", layout, message);
  for (std::size_t i = 0; i < values.size(); ++i) std::printf(" %s=%.17g", layout.signals[i].name, values[i]);
  std::printf("\n");
  return true;
}

void print_unpacked(const MessageLayout& layout, std::mt19937_64& random) {
  ports::CanMessage message = blank(layout);
  for (std::size_t i = 0; i < layout.length; ++i) message.data[i] = static_cast<uint8_t>(random());
  print_bytes("unpack", layout, message);
  for (const Signal& signal : layout.signals)
    std::printf(" %s=%" PRId64 ",%.17g", signal.name, raw_of(signal, message), value_of(signal, message));
  std::printf("\n");
}

bool print_all(const MessageLayout& layout, std::mt19937_64& random) {
  bool ok = print_packed(layout, at_minimum, random) && print_packed(layout, at_maximum, random);
  for (int i = 0; i < kRandomRounds; ++i) {
    ok = ok && print_packed(layout, anywhere, random);
    print_unpacked(layout, random);
  }
  return ok;
}

}  // namespace
}  // namespace roomcal::drivers

int main() {
  std::mt19937_64 random(20240605);
  bool ok = true;
  for (const auto* layout : roomcal::drivers::dbc::kMessages) ok = roomcal::drivers::print_all(*layout, random) && ok;
  for (const auto* layout : roomcal::drivers::cases::kMessages) ok = roomcal::drivers::print_all(*layout, random) && ok;
  return ok ? 0 : 1;
}
