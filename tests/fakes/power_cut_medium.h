#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/ports/medium.h"

namespace roomcal::fakes {

using Image = std::vector<std::byte>;

/// One thing that was asked of the medium and changes it.
struct MediumOp {
  enum class Kind : uint8_t { kWrite, kSync } kind = Kind::kWrite;
  std::size_t offset = 0;  ///< of a write
  Image page;              ///< of a write
};

inline constexpr std::size_t kNever = SIZE_MAX;

/// Scripted trouble; numbers count operations of their kind from 0 since the script was set.
struct MediumScript {
  std::size_t fail_read = kNever;   ///< this read fails
  std::size_t fail_write = kNever;  ///< this write fails, its page is left half written
  std::size_t fail_sync = kNever;   ///< this sync fails, nothing pending reaches the medium
  std::size_t lose_write = kNever;  ///< this write is acknowledged and only ever reaches the cache
  std::size_t flip_write = kNever;  ///< this write reaches the medium with one bit wrong
  std::size_t cut_op = kNever;      ///< power goes during this write or sync (counted together)
  std::size_t cut_byte = 0;         ///< of a cut write: bytes of its page that arrive
  bool from_then_on = false;        ///< failures repeat for ever
};

/// A medium with a volatile cache in front of it. Writes go to the cache, sync() moves them on, drop_caches() forgets
/// what the cache claims, a power cut leaves only what was moved on and, of the rest, what the script says.
class PowerCutMedium final : public ports::Medium {
 public:
  PowerCutMedium(std::size_t size, std::size_t page);

  std::size_t size_bytes() const override { return durable_.size(); }
  std::size_t page_bytes() const override { return page_; }
  Status read(std::size_t offset, std::span<std::byte> out) override;
  Status write_page(std::size_t offset, std::span<const std::byte> page) override;
  Status sync() override;
  Status drop_caches() override;

  void set_script(const MediumScript& script);
  /// Power again: cache empty, script forgotten.
  void power_on();
  /// What is there without power.
  const Image& durable() const { return durable_; }
  void set_durable(const Image& image);
  std::byte& durable_byte(std::size_t at);

  /// Operations since the script was set.
  const std::vector<MediumOp>& trace() const { return trace_; }
  std::size_t reads() const { return reads_; }
  std::size_t writes() const { return writes_; }
  std::size_t syncs() const { return syncs_; }

 private:
  bool dead() const { return cut_; }
  bool hits(std::size_t number, std::size_t scripted) const {
    return number == scripted || (script_.from_then_on && scripted != kNever && number > scripted);
  }
  static void copy(std::span<const std::byte> from, Image& to, std::size_t offset);

  std::size_t page_;
  Image durable_;
  Image cached_;                   ///< what reads see
  std::vector<MediumOp> pending_;  ///< acknowledged, not yet durable
  std::vector<MediumOp> trace_;
  MediumScript script_;
  std::size_t reads_ = 0, writes_ = 0, syncs_ = 0;
  bool cut_ = false;
};

}  // namespace roomcal::fakes
