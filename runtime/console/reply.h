#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "runtime/base/status.h"
#include "runtime/base/text_writer.h"

namespace roomcal::console {

/// An answer, said once by the handler and written for a person ("key: value" lines, indented) or a machine (JSON).
///
/// Inside a list, keys are ignored: pass {}. Groups nest up to kMaxDepth; deeper ones are left out whole.
class Reply {
 public:
  static constexpr std::size_t kMaxDepth = 6;

  Reply(TextWriter& out, bool json) : out_(out), json_(json) {}

  void text(std::string_view key, std::string_view value);
  /// For a person with `decimals` and its unit behind; for a machine in full, and null where not finite.
  void number(std::string_view key, double value, int decimals, std::string_view unit = {});
  void integer(std::string_view key, int64_t value);
  void flag(std::string_view key, bool value);
  /// A text of many lines: as it is for a person, one string for a machine.
  void document(std::string_view key, std::string_view lines);

  void open(std::string_view key) { open_group(key, false); }
  void close() { close_group(false); }
  void open_list(std::string_view key) { open_group(key, true); }
  void close_list() { close_group(true); }

  bool json() const { return json_; }

 private:
  bool begin(std::string_view key);
  void open_group(std::string_view key, bool list);
  void close_group(bool list);

  TextWriter& out_;
  bool json_;
  std::size_t depth_ = 0;
  std::size_t too_deep_ = 0;
  bool has_items_[kMaxDepth + 1] = {};
  bool is_list_[kMaxDepth + 1] = {};
};

}  // namespace roomcal::console
