#include "tools/evaluate/built_from_commit.h"

#include "tools/evaluate/commit.h"  // written by commit.cmake

namespace roomcal::tools {

std::string built_from_commit() { return kCommit; }

}  // namespace roomcal::tools
