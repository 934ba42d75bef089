#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

using FolderPath = FixedText<200>;
using FilePath = std::array<char, 256>;  ///< ends with a zero

/// Which of a folder's shots all replayed sensors of one device show.
///
/// A folder holds `shot000/`, `shot001/`, ... without a gap, or is itself the one shot. The rule: a shot is shown, over
/// and over, until the board calls advance(), as it does when a grab is complete; what is exposed or sent from that
/// moment on is of the next shot, and of the first one again after the last.
class ReplayCursor {
 public:
  static constexpr int kMaxShots = 1000;

  /// Looks what is there; shows the first shot since `now_ns`.
  /// @return kNotFound if there is no such folder. kInvalidArgument for a path that is too long.
  Status open(const FolderPath& folder, int64_t now_ns);

  int shots() const { return shots_; }
  /// When the replay began: images are exposed at whole periods since then, so those of all cameras fall together.
  int64_t epoch_ns() const { return epoch_ns_; }

  /// On to the next shot. Any thread.
  void advance(int64_t now_ns);

  struct Place {
    int shot = 0;
    int64_t since_ns = 0;
  };
  /// What was shown at `at_ns`, which is at or after the last but one advance(). Any thread.
  Place at(int64_t at_ns) const;

  /// `<folder>/shot<NNN>/<sensor><extension>`, or `<folder>/<sensor><extension>`.
  FilePath path(int shot, std::string_view sensor, std::string_view extension) const;

 private:
  FilePath folder_of(int shot) const;

  FolderPath folder_;
  int shots_ = 0;
  bool numbered_ = false;
  int64_t epoch_ns_ = 0;
  mutable std::mutex mutex_;
  Place now_, before_;
};

}  // namespace roomcal::drivers
