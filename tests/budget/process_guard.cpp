// Linked into a program, counts what its threads ask of the system's memory: every call of the heap, and every mapping
// and break. SIGUSR1 begins, SIGUSR2 tells on standard error ("guard: 0 calls") and goes on; with
// ROOMCAL_GUARD_FROM_START in the environment it begins at once and tells at the end. The first calls are shown with
// where they came from. Not in sanitizer builds, which bring their own allocator.

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <execinfo.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* place, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* place);
}

namespace {

constexpr int kShown = 5, kDepth = 24;

std::atomic<bool> counting{false};
std::atomic<unsigned long> calls{0};

void count(const char* what) {
  if (!counting.load(std::memory_order_relaxed)) return;
  if (calls.fetch_add(1) >= kShown) return;
  void* frames[kDepth];
  const int depth = backtrace(frames, kDepth);
  dprintf(STDERR_FILENO, "guard: %s\n", what);
  backtrace_symbols_fd(frames, depth, STDERR_FILENO);
}

void begin(int /*signal*/) {
  calls = 0;
  counting = true;
}

void tell(int /*signal*/) {
  char text[64];
  const int size = std::snprintf(text, sizeof text, "guard: %lu calls\n", calls.load());
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, static_cast<std::size_t>(size));
}

[[gnu::constructor]] void listen() {
  void* frames[2];
  backtrace(frames, 2);  // its library is loaded now, and not in the middle of a count
  struct sigaction action {};
  action.sa_flags = SA_RESTART;
  action.sa_handler = begin;
  ::sigaction(SIGUSR1, &action, nullptr);
  action.sa_handler = tell;
  ::sigaction(SIGUSR2, &action, nullptr);
  if (std::getenv("ROOMCAL_GUARD_FROM_START") == nullptr) return;
  std::atexit([] { tell(0); });
  counting = true;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) {
  count("malloc");
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count("calloc");
  return __libc_calloc(number, size);
}
void* realloc(void* place, std::size_t size) {
  count("realloc");
  return __libc_realloc(place, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count("aligned_alloc");
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** place, std::size_t alignment, std::size_t size) {
  count("posix_memalign");
  *place = __libc_memalign(alignment, size);
  return *place == nullptr ? ENOMEM : 0;
}
void free(void* place) {
  if (place != nullptr) count("free");
  __libc_free(place);
}
void* mmap(void* place, std::size_t size, int protection, int flags, int fd, off_t offset) noexcept {
  count("mmap");
  return reinterpret_cast<void*>(::syscall(SYS_mmap, place, size, protection, flags, fd, offset));
}
int brk(void* end) noexcept {
  count("brk");
  return static_cast<int>(::syscall(SYS_brk, end) < reinterpret_cast<long>(end) ? -1 : 0);
}

}  // extern "C"
