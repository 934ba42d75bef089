#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <variant>

#include "runtime/calib/limits.h"

namespace roomcal::calib {

/// One limit by its name, as device.yaml and a device's profile write it.
struct LimitField {
  std::string_view name;
  std::variant<double Limits::*, std::size_t Limits::*> field;
  double least = 0, most = 0;  ///< numbers that make sense, in the name's unit
  double unit = 1;             ///< SI units in one of the name's: a name that ends in _deg is in degrees

  bool whole() const { return std::holds_alternative<std::size_t Limits::*>(field); }
};

/// Every limit, once.
std::span<const LimitField> limit_table();

/// In the name's unit.
double get_limit(const Limits& limits, const LimitField& field);
/// @return false, and unchanged, for a number outside the field's range or not whole where it must be.
[[nodiscard]] bool set_limit(Limits& limits, const LimitField& field, double value);
/// @return nullptr if there is none of that name.
const LimitField* find_limit(std::string_view name);

}  // namespace roomcal::calib
