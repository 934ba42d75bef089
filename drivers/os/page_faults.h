#pragma once

#include <cstdint>

namespace roomcal::drivers {

struct PageFaults {
  uint64_t minor = 0;  ///< a page was missing, but not on the disk
  uint64_t major = 0;  ///< a page came from the disk
};

/// Counts the calling thread's page faults from its construction on; belongs to that thread.
class PageFaultMark {
 public:
  PageFaultMark();
  PageFaults since() const;

 private:
  PageFaults at_mark_;
};

}  // namespace roomcal::drivers
