#include "tools/common/progress.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>

namespace roomcal::tools {

namespace {
using Seconds = std::chrono::duration<double>;
constexpr double kQuiet_s = 1.0;  // shorter work shows nothing
}  // namespace

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      last_print_(start_) {}

Progress::~Progress() {
  if (printed_ && terminal_) fmt::print(stderr, "\n");
}

void Progress::step() {
  ++done_;
  const auto now = std::chrono::steady_clock::now();
  const bool long_work = Seconds(now - start_).count() > kQuiet_s;
  const std::size_t tenth = std::max<std::size_t>(1, total_ / 10);
  const bool due = terminal_ ? Seconds(now - last_print_).count() > 0.2 : done_ % tenth == 0;
  if (!long_work || !(due || (printed_ && done_ == total_))) return;
  last_print_ = now;
  printed_ = true;
  print();
}

void Progress::print() const {
  const double spent_s = Seconds(std::chrono::steady_clock::now() - start_).count();
  const double left_s = spent_s / static_cast<double>(done_) * static_cast<double>(total_ - std::min(done_, total_));
  fmt::print(stderr, "{}{}: {}/{}  {:.0f} s left{}", terminal_ ? "\r" : "", what_, done_, total_, left_s,
             terminal_ ? "   " : "\n");
}

}  // namespace roomcal::tools
