// freeze_thread TID: stops one thread of another process, as a deadlock would, for as long as this runs; the others go
// on.

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <sys/ptrace.h>
#include <unistd.h>

int main(int argc, char** argv) {
  const int thread = argc == 2 ? std::atoi(argv[1]) : 0;
  if (thread <= 0) {
    std::fprintf(stderr, "see the top of tests/guest/freeze_thread.cpp\n");
    return 100;
  }
  // Attaching stops the thread, and nobody lets it go on.
  if (::ptrace(PTRACE_ATTACH, thread, nullptr, nullptr) != 0) {
    std::fprintf(stderr, "freeze_thread: %d: %s\n", thread, std::strerror(errno));
    return 1;
  }
  for (;;) ::pause();
}
