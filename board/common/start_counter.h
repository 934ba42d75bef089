#pragma once

#include <string>

namespace roomcal::board {

/// Counts starts in a row that ended in a crash or a hang: a program that fails three times comes up in safe mode, with
/// the console alone, instead of failing for ever. A power cut is no failure, however often it comes.
///
/// | how the start before ended | told by | counted |
/// |---|---|---|
/// | in order, or later than a minute | well() | no, and those before it are forgotten |
/// | crashed, was killed | the machine is still the one that it started on | yes |
/// | hung, until a watchdog took the machine | hangs(), before the dog bit | yes |
/// | the power went | another boot of the machine, and no word | no |
class StartCounter {
 public:
  static constexpr int kTooMany = 3;

  /// @param file  one line, replaced whole; a file that cannot be read counts as none.
  /// @param boot  what names this run of the machine: the kernel's boot id. Empty: no start is taken for a power cut's.
  StartCounter(std::string file, std::string boot) : file_(std::move(file)), boot_(std::move(boot)) {}

  /// Another start. @return how many before it failed.
  int begin();
  /// This one is well: after a minute, or when it ends in order.
  void well();
  /// A thread does not answer: whatever ends this start now, it failed. Or they all answer again.
  void hangs(bool now);

 private:
  void write(int count, bool hung) const;

  std::string file_, boot_;
  int count_ = 0;  ///< with this start, should it fail
  bool told_ = false;
};

/// The kernel's name for this run of the machine; empty if it tells none.
std::string boot_id();

}  // namespace roomcal::board
