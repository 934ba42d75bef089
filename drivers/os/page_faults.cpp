#include "drivers/os/page_faults.h"

#include <sys/resource.h>

namespace roomcal::drivers {

namespace {

PageFaults of_this_thread() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return {static_cast<uint64_t>(usage.ru_minflt), static_cast<uint64_t>(usage.ru_majflt)};
}

}  // namespace

PageFaultMark::PageFaultMark() : at_mark_(of_this_thread()) {}

PageFaults PageFaultMark::since() const {
  const PageFaults now = of_this_thread();
  return {now.minor - at_mark_.minor, now.major - at_mark_.major};
}

}  // namespace roomcal::drivers
