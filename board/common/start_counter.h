#pragma once

#include <string>

namespace roomcal::board {

/// Counts starts that did not end well, over power cuts: a program that crashes three times in a row comes up in safe
/// mode, with the console alone, instead of crashing for ever.
class StartCounter {
 public:
  static constexpr int kTooMany = 3;

  /// @param file  one small number, replaced whole; a file that cannot be read counts as none.
  explicit StartCounter(std::string file) : file_(std::move(file)) {}

  /// Another start. @return how many before it did not end well.
  int begin();
  /// This one is well: after a minute, or when it ends in order.
  void well();

 private:
  void write(int count) const;

  std::string file_;
  bool told_ = false;
};

}  // namespace roomcal::board
