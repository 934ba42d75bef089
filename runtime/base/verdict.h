#pragma once

#include <cstdint>

namespace roomcal {

/// What a press came to. Only the first two may be written to the store.
enum class Verdict : uint8_t {
  kPass,
  kPassAdvise,   ///< good, and there is something that the operator should know
  kFailRetry,    ///< the operator can mend it: light, position, obstacles
  kFailService,  ///< it takes a person with tools: a moved camera, a wrong map
};

/// "PASS", "PASS_ADVISE", "FAIL_RETRY", "FAIL_SERVICE".
const char* to_string(Verdict verdict);
constexpr bool may_write(Verdict verdict) { return verdict == Verdict::kPass || verdict == Verdict::kPassAdvise; }

}  // namespace roomcal
