#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"

namespace roomcal::board {

/// Memory of the size that stacks come in.
struct alignas(4096) StackPage {
  std::byte bytes[4096];
};

/// A stack's bytes with its guard page, as the plan counts them.
constexpr std::size_t stack_bytes(std::size_t usable) {
  return ((usable + sizeof(StackPage) - 1) / sizeof(StackPage) + 2) * sizeof(StackPage);
}

/// @return empty if the arena refuses.
inline std::span<std::byte> take_stack(std::size_t usable, Arena& arena) {
  const std::size_t pages = stack_bytes(usable) / sizeof(StackPage) - 1;
  return std::as_writable_bytes(arena.allocate_uninitialized<StackPage>(pages));
}

}  // namespace roomcal::board
