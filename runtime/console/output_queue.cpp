#include "runtime/console/output_queue.h"

#include <algorithm>

namespace roomcal::console {

void OutputQueue::put(std::string_view text) {
  for (const char c : text) {
    ring_[(first_ + size_) % ring_.size()] = c;
    ++size_;
  }
}

bool OutputQueue::push(std::string_view message, std::string_view newline) {
  const auto newlines = static_cast<std::size_t>(std::count(message.begin(), message.end(), '\n'));
  const std::size_t bytes = message.size() - newlines + newlines * newline.size();
  if (bytes > ring_.size() - size_) {
    ++lost_messages_;
    lost_bytes_ += bytes;
    return false;
  }
  std::size_t from = 0;
  for (std::size_t at = message.find('\n'); at != std::string_view::npos; at = message.find('\n', from)) {
    put(message.substr(from, at - from));
    put(newline);
    from = at + 1;
  }
  put(message.substr(from));
  return true;
}

void OutputQueue::pump(ports::ByteSink& sink) {
  while (size_ > 0) {
    const std::size_t run = std::min(size_, ring_.size() - first_);
    const std::size_t taken = std::min(run, sink.write_some({ring_.data() + first_, run}));
    first_ = (first_ + taken) % ring_.size();
    size_ -= taken;
    if (taken < run) return;
  }
}

}  // namespace roomcal::console
