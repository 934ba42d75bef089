#include "runtime/store/slot.h"

#include <algorithm>

#include "runtime/store/record_codec.h"

namespace roomcal::store {

namespace {

constexpr std::byte kErased{0xFF};

bool all_are(std::span<const std::byte> bytes, std::byte value) {
  return std::all_of(bytes.begin(), bytes.end(), [value](std::byte b) { return b == value; });
}

bool is_blank(std::span<const std::byte> bytes) { return all_are(bytes, kErased) || all_are(bytes, std::byte{0}); }

// Doubles and the builder want 8 and 16; the arena aligns to the type.
struct alignas(16) Block {
  std::byte bytes[16];
};

std::span<std::byte> allocate_bytes(Arena& arena, std::size_t size) {
  const std::span<Block> blocks = arena.allocate<Block>((size + sizeof(Block) - 1) / sizeof(Block));
  return blocks.empty() ? std::span<std::byte>{} : std::as_writable_bytes(blocks).first(size);
}

}  // namespace

const char* to_string(SlotCondition condition) {
  switch (condition) {
    case SlotCondition::kEmpty:
      return "empty";
    case SlotCondition::kValid:
      return "valid";
    case SlotCondition::kReadError:
      return "read error";
    case SlotCondition::kBadHeader:
      return "torn or damaged header";
    case SlotCondition::kBadContent:
      return "torn or damaged content";
    case SlotCondition::kUnsupported:
      return "another version";
    case SlotCondition::kForeign:
      return "another device's record";
  }
  return "unknown";
}

Status SlotAccess::open(ports::Medium& medium, Arena& arena) {
  const Result<Layout> layout = Layout::plan(medium);
  ROOMCAL_TRY(layout.status());
  layout_ = layout.value();
  medium_ = &medium;
  image_ = allocate_bytes(arena, layout_.slot_bytes);
  reading_ = allocate_bytes(arena, layout_.slot_bytes);
  scratch_ = allocate_bytes(arena, kEncodeScratchBytes);
  return image_.empty() || reading_.empty() || scratch_.empty() ? out_of_arena("the store's slot buffers")
                                                                : ok_status();
}

SlotCondition SlotAccess::read_blank(Slot slot) {
  if (!medium_->read(layout_.offset(slot), reading_).ok()) return SlotCondition::kReadError;
  return is_blank(reading_) ? SlotCondition::kEmpty : SlotCondition::kBadHeader;
}

SlotCondition SlotAccess::read(Slot slot, Record& record) {
  const std::span<std::byte> header = reading_.first(sizeof(RecordHeader));
  if (!medium_->read(layout_.offset(slot), header).ok()) return SlotCondition::kReadError;
  if (is_blank(header)) return read_blank(slot);
  const Result<std::size_t> size = record_size(header);
  if (size.status().code() == StatusCode::kUnsupported) return SlotCondition::kUnsupported;
  if (!size.ok() || size.value() > layout_.slot_bytes) return SlotCondition::kBadHeader;
  const std::span<std::byte> rest = reading_.subspan(header.size(), size.value() - header.size());
  if (!medium_->read(layout_.offset(slot) + header.size(), rest).ok()) return SlotCondition::kReadError;
  return decode_record(reading_.first(size.value()), record).ok() ? SlotCondition::kValid : SlotCondition::kBadContent;
}

Status SlotAccess::write_image(Slot slot, std::size_t size) {
  const std::size_t page = layout_.page_bytes;
  for (std::size_t at = 0; at < size; at += page)
    ROOMCAL_TRY(medium_->write_page(layout_.offset(slot) + at, image_.subspan(at, page)));
  ROOMCAL_TRY(medium_->sync());
  return medium_->drop_caches();
}

Status SlotAccess::compare(Slot slot, std::size_t size) {
  const std::span<std::byte> back = reading_.first(size);
  ROOMCAL_TRY(medium_->read(layout_.offset(slot), back));
  if (!std::equal(back.begin(), back.end(), image_.begin()))
    return {StatusCode::kCorrupt, "the store read back something else than was written; the medium is worn or broken"};
  return ok_status();
}

Status SlotAccess::write_verified(Slot slot, const Record& record) {
  std::fill(image_.begin(), image_.end(), kErased);
  const Result<std::size_t> size = encode_record(record, image_, scratch_);
  ROOMCAL_TRY(size.status());
  ROOMCAL_TRY(write_image(slot, size.value()));
  return compare(slot, size.value());
}

Status SlotAccess::erase(Slot slot) {
  std::fill(image_.begin(), image_.end(), kErased);
  ROOMCAL_TRY(write_image(slot, layout_.slot_bytes));
  return compare(slot, layout_.slot_bytes);
}

bool SlotAccess::holds(Slot slot, const Record& record) {
  const Result<std::size_t> size = encode_record(record, image_, scratch_);
  return size.ok() && compare(slot, size.value()).ok();
}

}  // namespace roomcal::store
