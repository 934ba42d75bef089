#include "board/common/event_log.h"

#include <algorithm>

#include <unistd.h>

#include "runtime/base/text_writer.h"

namespace roomcal::board {

void EventLog::note(std::string_view who, std::string_view what) {
  std::array<char, 220> text{};
  TextWriter out({text.data(), text.size() - 1});
  out.fixed(static_cast<double>(clocks_.now_ns()) * 1e-9, 3).text(" ").text(who).text(": ");
  const std::size_t room = text.size() - 1 - out.view().size();
  out.text(what.substr(0, room));
  const std::lock_guard lock(mutex_);
  lines_[count_++ % kLines] = Line(out.view());
  if (!to_stderr_) return;
  text[out.view().size()] = '\n';
  // What nobody reads is in the ring all the same.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), out.view().size() + 1);
}

void EventLog::read(std::size_t lines, void (*visit)(void* context, std::string_view line), void* context) const {
  const std::lock_guard lock(mutex_);
  const uint64_t have = std::min<uint64_t>({count_, kLines, lines});
  for (uint64_t i = count_ - have; i < count_; ++i) visit(context, lines_[i % kLines].view());
}

uint64_t EventLog::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

}  // namespace roomcal::board
