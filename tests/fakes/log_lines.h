#pragma once

#include <algorithm>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/ports/log.h"

namespace roomcal::fakes {

/// Keeps every line, "who: what". Any thread.
class LogLines final : public ports::Log {
 public:
  void note(std::string_view who, std::string_view what) override {
    const std::lock_guard lock(mutex_);
    lines_.push_back(std::string(who) + ": " + std::string(what));
  }

  std::vector<std::string> lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }
  /// How many lines contain `text`.
  std::size_t count(std::string_view text) const {
    const std::vector<std::string> all = lines();
    return static_cast<std::size_t>(std::count_if(
        all.begin(), all.end(), [&](const std::string& line) { return line.find(text) != std::string::npos; }));
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

}  // namespace roomcal::fakes
