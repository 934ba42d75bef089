#pragma once

#include <string>

#include "tools/common/ring_bank.h"

namespace roomcal::tools {

/// Ratios as people write them: "85,70,55,40,25" (percent, as CCTag's bank does), "0.85,0.7,..." (of the outer radius),
/// or "id7" for CCTag-3 identity 7.
/// @return six radii, the first 1.
/// @throws ToolError unless there are five numbers that fall, each ring at least 5 % of the radius wide, the innermost
/// disc at least 10 %.
RingRadii parse_ratios(const std::string& text);

}  // namespace roomcal::tools
