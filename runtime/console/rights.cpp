#include "runtime/console/rights.h"

#include <algorithm>

namespace roomcal::console {

const char* to_string(Rights rights) {
  switch (rights) {
    case Rights::kObserve:
      return "observe";
    case Rights::kOperate:
      return "operate";
    case Rights::kService:
      return "service";
  }
  return "observe";
}

void RightsGate::grant(Rights rights, int64_t now_ns) {
  rights_ = std::max(rights_, rights);
  until_ns_ = now_ns + hold_ns_;
}

bool RightsGate::lapse(int64_t now_ns) {
  if (rights_ == Rights::kObserve || now_ns < until_ns_) return false;
  revoke();
  return true;
}

}  // namespace roomcal::console
