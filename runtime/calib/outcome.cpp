#include "runtime/calib/outcome.h"

namespace roomcal::calib {

const char* to_string(Stage stage) {
  switch (stage) {
    case Stage::kDetect:
      return "detect";
    case Stage::kLocate:
      return "locate";
    case Stage::kRefine:
      return "refine";
    case Stage::kJudge:
      return "judge";
    case Stage::kCount:
      break;
  }
  return "unknown";
}

}  // namespace roomcal::calib
