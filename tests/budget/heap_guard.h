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

/// The same of all threads together but those that stand outside; one at a time.
class ThreadsHeapGuard {
 public:
  ThreadsHeapGuard();
  ~ThreadsHeapGuard();
  ThreadsHeapGuard(const ThreadsHeapGuard&) = delete;
  ThreadsHeapGuard& operator=(const ThreadsHeapGuard&) = delete;

  std::size_t calls() const;

  /// The calling thread is the test's own: it is not counted from here on.
  static void stand_outside();
};

}  // namespace roomcal::budget
