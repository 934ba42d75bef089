#pragma once

#include <string>
#include <vector>

namespace roomcal::tools {

/// One of the paper's experiments: ours beside it.
struct PaperTable {
  std::string title;
  std::string text;                            ///< how it was measured; Markdown
  std::vector<std::vector<std::string>> rows;  ///< the first one is the heading
  std::vector<std::string> worse;              ///< rows where ours is not better than the paper, one line each
  int wrong = 0;                               ///< extrinsics that would be written and are wrong
};

/// "3.1": three significant digits, no exponent.
std::string figure(double value);

/// "12 x" of how much smaller ours is; a dash where the paper has no figure.
std::string times_smaller(double paper, double ours);

}  // namespace roomcal::tools
