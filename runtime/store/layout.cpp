#include "runtime/store/layout.h"

#include <algorithm>
#include <array>
#include <bit>

#include "runtime/store/format.h"

namespace roomcal::store {

namespace {

constexpr std::size_t kMinSlotBytes = 1024;  // two cameras and their evidence

constexpr std::array<const char*, kSlotCount> kNames{"factory",   "A",         "B",         "history 0",
                                                     "history 1", "history 2", "history 3", "history 4",
                                                     "history 5", "history 6", "history 7"};

}  // namespace

const char* to_string(Slot slot) {
  const auto number = static_cast<std::size_t>(slot);
  return number < kSlotCount ? kNames[number] : "none";
}

Result<Layout> Layout::plan(std::size_t medium_bytes, std::size_t page) {
  if (!std::has_single_bit(page) || page > kMaxPageBytes)
    return Status(StatusCode::kInvalidArgument, "the store's page size is not a power of two up to 65536");
  // Large enough for any record where there is room, an eleventh of the medium where not.
  const std::size_t most = (kMaxRecordBytes + page - 1) / page * page;
  const std::size_t slot = std::min(most, medium_bytes / kSlotCount / page * page);
  if (slot < kMinSlotBytes)
    return Status(StatusCode::kCapacity, "the store's medium is too small; it takes 11 slots of 1 KiB or more");
  return Layout{slot, page};
}

}  // namespace roomcal::store
