#include "tests/budget/heap_guard.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>

namespace {
// Plain and trivially constructed: the allocator is called before any constructor has run.
thread_local bool counting = false;
thread_local std::size_t call_count = 0;
thread_local bool outside = false;
std::atomic<bool> counting_all{false};
std::atomic<std::size_t> all_calls{0};
}  // namespace

#if !defined(__SANITIZE_ADDRESS__)  // a sanitizer that does not see all memory takes what it misses for leaks
extern "C" {
// glibc's own entry points behind the public names (malloc/malloc.c).
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* place, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* place);
}

namespace {
void count_call() {
  if (counting) ++call_count;
  if (counting_all.load(std::memory_order_relaxed) && !outside) all_calls.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

extern "C" {

void* malloc(std::size_t size) {
  count_call();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  count_call();
  return __libc_calloc(count, size);
}

void* realloc(void* place, std::size_t size) {
  count_call();
  return __libc_realloc(place, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_call();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** place, std::size_t alignment, std::size_t size) {
  count_call();
  *place = __libc_memalign(alignment, size);
  return *place == nullptr ? ENOMEM : 0;
}

void free(void* place) {
  if (place != nullptr) count_call();
  __libc_free(place);
}

}  // extern "C"
#endif

namespace roomcal::budget {

HeapGuard::HeapGuard() {
  call_count = 0;
  counting = true;
}

HeapGuard::~HeapGuard() { counting = false; }

std::size_t HeapGuard::calls() const { return call_count; }

ThreadsHeapGuard::ThreadsHeapGuard() {
  all_calls = 0;
  counting_all = true;
}

ThreadsHeapGuard::~ThreadsHeapGuard() { counting_all = false; }

std::size_t ThreadsHeapGuard::calls() const { return all_calls; }

void ThreadsHeapGuard::stand_outside() { outside = true; }

}  // namespace roomcal::budget
