#include "runtime/console/reply.h"

#include <cmath>

namespace roomcal::console {

// Comma and key, or indentation and key. @return false where nothing may be written.
bool Reply::begin(std::string_view key) {
  if (too_deep_ > 0) return false;
  const bool list = is_list_[depth_];
  if (json_) {
    if (has_items_[depth_]) out_.text(",");
    if (!list) out_.quoted(key).text(":");
  } else {
    for (std::size_t i = 0; i < depth_; ++i) out_.text("  ");
    if (list)
      out_.text("- ");
    else
      out_.text(key).text(": ");
  }
  has_items_[depth_] = true;
  return true;
}

void Reply::text(std::string_view key, std::string_view value) {
  if (!begin(key)) return;
  if (json_)
    out_.quoted(value);
  else
    out_.text(value).text("\n");
}

void Reply::number(std::string_view key, double value, int decimals, std::string_view unit) {
  if (!begin(key)) return;
  if (json_) {
    if (std::isfinite(value))
      out_.number(value);
    else
      out_.text("null");
    return;
  }
  out_.fixed(value, decimals).text(unit.empty() ? "" : " ").text(unit).text("\n");
}

void Reply::integer(std::string_view key, int64_t value) {
  if (begin(key)) out_.integer(value).text(json_ ? "" : "\n");
}

void Reply::flag(std::string_view key, bool value) {
  if (!begin(key)) return;
  if (json_)
    out_.text(value ? "true" : "false");
  else
    out_.text(value ? "yes\n" : "no\n");
}

void Reply::document(std::string_view key, std::string_view lines) {
  if (json_) return text(key, lines);
  if (too_deep_ == 0) out_.text(lines).text(lines.ends_with('\n') ? "" : "\n");
}

void Reply::open_group(std::string_view key, bool list) {
  if (too_deep_ > 0 || depth_ == kMaxDepth) {
    ++too_deep_;
    return;
  }
  static_cast<void>(begin(key));
  out_.text(json_ ? (list ? "[" : "{") : "\n");
  ++depth_;
  has_items_[depth_] = false;
  is_list_[depth_] = list;
}

void Reply::close_group(bool list) {
  if (too_deep_ > 0) {
    --too_deep_;
    return;
  }
  if (depth_ == 0) return;
  --depth_;
  if (json_) out_.text(list ? "]" : "}");
}

}  // namespace roomcal::console
