#pragma once

#include <string>

namespace roomcal::tools {

/// Short hash of the commit whose sources this program was built from; with "+changes" behind it if sources were
/// changed since, "unknown" if it was built outside a clone.
std::string built_from_commit();

}  // namespace roomcal::tools
