#include "runtime/base/status.h"

namespace roomcal {

const char* to_string(StatusCode code) {
  switch (code) {
    case StatusCode::kOk:
      return "ok";
    case StatusCode::kInvalidArgument:
      return "invalid argument";
    case StatusCode::kOutOfRange:
      return "out of range";
    case StatusCode::kNotFound:
      return "not found";
    case StatusCode::kTooFew:
      return "too few";
    case StatusCode::kDegenerate:
      return "degenerate";
    case StatusCode::kAmbiguous:
      return "ambiguous";
    case StatusCode::kNotConverged:
      return "not converged";
    case StatusCode::kCapacity:
      return "capacity";
    case StatusCode::kOutOfMemory:
      return "out of memory";
    case StatusCode::kCorrupt:
      return "corrupt";
    case StatusCode::kUnsupported:
      return "unsupported";
    case StatusCode::kUnavailable:
      return "unavailable";
    case StatusCode::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

}  // namespace roomcal
