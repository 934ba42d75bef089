#include "runtime/base/arena.h"

#include <algorithm>

namespace roomcal {

void* Arena::allocate_bytes(std::size_t size, std::size_t alignment) {
  if (size == 0) return nullptr;
  const auto base = reinterpret_cast<std::uintptr_t>(bytes_.data());
  const std::uintptr_t aligned = (base + used_ + alignment - 1) & ~(static_cast<std::uintptr_t>(alignment) - 1);
  const std::size_t start = aligned - base;
  if (sealed_ || start > bytes_.size() || size > bytes_.size() - start) {
    ++refusals_;
    return nullptr;
  }
  used_ = start + size;
  peak_ = std::max(peak_, used_);
  return bytes_.data() + start;
}

Result<Arenas> Arenas::carve(std::span<std::byte> block, std::size_t permanent_bytes, std::size_t scratch_bytes) {
  if (permanent_bytes > block.size() || scratch_bytes > block.size() - permanent_bytes)
    return out_of_arena("memory block is smaller than its permanent and scratch parts: give the board a larger block");
  const std::size_t step_bytes = block.size() - permanent_bytes - scratch_bytes;
  Arenas arenas;
  arenas.permanent = Arena(block.first(permanent_bytes));
  arenas.step = Arena(block.subspan(permanent_bytes, step_bytes));
  arenas.scratch = Arena(block.last(scratch_bytes));
  return arenas;
}

}  // namespace roomcal
