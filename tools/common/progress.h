#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace roomcal::tools {

/// One line on stderr with count and time left, redrawn on a terminal, every tenth elsewhere. Silent for short work.
class Progress {
 public:
  Progress(std::string what, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step();

 private:
  void print() const;

  std::string what_;
  std::size_t total_;
  std::size_t done_ = 0;
  bool terminal_;
  bool printed_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_print_;
};

}  // namespace roomcal::tools
