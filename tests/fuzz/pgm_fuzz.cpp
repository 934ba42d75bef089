#include <cstring>
#include <memory>

#include "drivers/replay/pgm.h"

// Whatever the head is, a size that is believed is one, and pixels begin behind what was read.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  using namespace roomcal;
  // A heap block of exactly this size, so that reading one byte too far is seen.
  const std::unique_ptr<std::byte[]> file(new std::byte[size]);
  if (size > 0) std::memcpy(file.get(), data, size);
  const Result<drivers::PgmHead> head = drivers::read_pgm_head({file.get(), size});
  if (!head.ok()) return 0;
  const drivers::PgmHead& found = head.value();
  if (found.width_px < 1 || found.width_px > 65535 || found.height_px < 1 || found.height_px > 65535) __builtin_trap();
  if (found.pixels_at > size || found.pixels_at > drivers::kMaxPgmHead) __builtin_trap();
  return 0;
}
