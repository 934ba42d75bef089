#pragma once

#include <cstddef>

namespace roomcal::budget {

/// Counts heap calls (malloc, calloc, realloc, aligned_alloc, posix_memalign, free of non-null, and so every new and
/// delete) of the calling thread while it lives. Guards do not nest.
///
/// Works by interposing the C library's allocator in the test program; not in sanitizer builds, which bring their own.
class HeapGuard {
 public:
  HeapGuard();
  ~HeapGuard();
  HeapGuard(const HeapGuard&) = delete;
  HeapGuard& operator=(const HeapGuard&) = delete;

  std::size_t calls() const;
};

}  // namespace roomcal::budget
