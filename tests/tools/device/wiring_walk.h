#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "tools/device/wiring_fields.h"

/// Visitors for walk() of tools/device/wiring_fields.h, and the proof that it walks over everything.
namespace roomcal::tools::test {

/// Gives one field, by its number, another value that a device may have too: a text another last character, a number
/// its double (0: 1), an enumeration its next value.
class ChangeField {
 public:
  explicit ChangeField(std::size_t wanted) : wanted_(wanted) {}

  template <typename Enum, std::size_t kCount>
  void choice(std::string_view key, Enum& value, const std::array<std::string_view, kCount>&) {
    if (is_it(key)) value = static_cast<Enum>((static_cast<std::size_t>(value) + 1) % kCount);
  }
  template <std::size_t kCapacity>
  void text(std::string_view key, FixedText<kCapacity>& value) {
    if (is_it(key)) value = std::string_view(another(value.view()));
  }
  template <std::size_t kCapacity, std::size_t kCount>
  void texts(std::string_view key, FixedVector<FixedText<kCapacity>, kCount>& values) {
    if (!is_it(key)) return;
    if (values.empty()) static_cast<void>(values.push_back("GREY"));
    values.back() = std::string_view(another(values.back().view()));
  }
  template <typename Number>
  void number(std::string_view key, Number& value) {
    if (is_it(key)) value = value == Number(0) ? Number(1) : static_cast<Number>(2 * value);
  }
  void flag(std::string_view key, bool& value) {
    if (is_it(key)) value = !value;
  }

  /// Key of the field that was changed; empty if the struct has fewer.
  std::string_view changed() const { return changed_; }
  std::size_t fields() const { return seen_; }

 private:
  bool is_it(std::string_view key) {
    const bool it = seen_++ == wanted_;
    if (it) changed_ = key;
    return it;
  }
  static std::string another(std::string_view text) {
    std::string result(text.empty() ? "0" : text);
    result.back() = result.back() >= '0' && result.back() < '9' ? static_cast<char>(result.back() + 1) : '1';
    return result;
  }

  std::size_t wanted_;
  std::size_t seen_ = 0;
  std::string_view changed_;
};

/// Something that any member can be made of.
struct Anything {
  template <typename T>
  operator T() const;  // NOLINT: implicit is its purpose; only ever named in unevaluated operands
};

/// Members of an aggregate without arrays and bases: as many as it can be initialized from.
template <typename Aggregate, typename... Members>
constexpr std::size_t member_count(Members... members) {
  if constexpr (requires { Aggregate{members..., Anything{}}; })
    return member_count<Aggregate>(members..., Anything{});
  else
    return sizeof...(Members);
}

/// Fields that walk() visits.
template <typename Wiring>
std::size_t walked_fields() {
  Wiring wiring;
  ChangeField count(SIZE_MAX);
  walk(wiring, count);
  return count.fields();
}

}  // namespace roomcal::tools::test
