#include "runtime/base/verdict.h"

namespace roomcal {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "PASS";
    case Verdict::kPassAdvise:
      return "PASS_ADVISE";
    case Verdict::kFailRetry:
      return "FAIL_RETRY";
    case Verdict::kFailService:
      return "FAIL_SERVICE";
  }
  return "FAIL_SERVICE";
}

}  // namespace roomcal
