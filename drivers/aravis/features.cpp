#include "drivers/aravis/features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "drivers/aravis/glib_handle.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

// Calls of GLib's style want text that ends with a zero.
template <std::size_t kSize>
class Terminated {
 public:
  explicit Terminated(std::string_view text) {
    std::copy_n(text.begin(), std::min(text.size(), kSize), chars_.begin());
  }
  const char* c_str() const { return chars_.data(); }

 private:
  std::array<char, kSize + 1> chars_{};
};

// 5000, 5000.0 and 5e3 are one value; so are true and 1.
bool same_value(std::string_view a, std::string_view b) {
  if (a == b) return true;
  const Terminated<63> one(a), other(b);
  char* end_of_one = nullptr;
  char* end_of_other = nullptr;
  const double x = g_ascii_strtod(one.c_str(), &end_of_one);
  const double y = g_ascii_strtod(other.c_str(), &end_of_other);
  return !a.empty() && !b.empty() && *end_of_one == '\0' && *end_of_other == '\0' && x == y;
}

}  // namespace

ArvGcFeatureNode* Features::node(const char* name) const {
  if (device_ == nullptr) return nullptr;
  ArvGcNode* node = arv_device_get_feature(device_, name);
  return ARV_IS_GC_FEATURE_NODE(node) ? ARV_GC_FEATURE_NODE(node) : nullptr;
}

bool Features::has(const char* name) const {
  ArvGcFeatureNode* feature = node(name);
  return feature != nullptr && arv_gc_feature_node_is_available(feature, nullptr) != FALSE;
}

bool Features::has_entry(const char* name, const char* entry) const {
  return has(name) && arv_device_is_enumeration_entry_available(device_, name, entry, nullptr) != FALSE;
}

FixedText<63> Features::get(const char* name) const {
  if (!has(name)) return {};
  GErrorSlot error;
  const char* text = arv_gc_feature_node_get_value_as_string(node(name), error.out());
  return text == nullptr || error.failed() ? FixedText<63>() : FixedText<63>(text);
}

double Features::get_number(const char* name, double otherwise) const {
  const FixedText<63> text = get(name);
  return text.empty() ? otherwise : g_ascii_strtod(Terminated<63>(text.view()).c_str(), nullptr);
}

bool Features::set_for_good(const char* name, std::string_view value) {
  error_.clear();
  ArvGcFeatureNode* feature = node(name);
  if (feature == nullptr) {
    error_.append(name);
    error_.append(" is not a feature of the camera");
    return false;
  }
  GErrorSlot error;
  arv_gc_feature_node_set_value_from_string(feature, Terminated<63>(value).c_str(), error.out());
  error_.append(error.message());
  return !error.failed();
}

bool Features::set(const char* name, std::string_view value) {
  const FixedText<63> before = get(name);
  if (same_value(before.view(), value)) return true;
  if (!set_for_good(name, value)) return false;
  if (!before.empty() && !changes_.push_back({name, before})) error_.append("more changes than can be undone");
  return true;
}

bool Features::set_number(const char* name, double value) {
  std::array<char, 40> text;
  TextWriter out(text);
  // Integers take no decimal point.
  if (value == std::floor(value) && std::abs(value) < 9e15)
    out.integer(static_cast<int64_t>(value));
  else
    out.number(value);
  return set(name, out.view());
}

bool Features::set_clamped(const char* name, double& value) {
  if (!has(name)) return set_number(name, value);
  double least = value, most = value;
  if (ArvGcNode* feature = arv_device_get_feature(device_, name); ARV_IS_GC_FLOAT(feature)) {
    GErrorSlot error;
    arv_device_get_float_feature_bounds(device_, name, &least, &most, error.out());
    if (error.failed()) least = most = value;
  } else if (ARV_IS_GC_INTEGER(feature)) {
    gint64 lowest = 0, highest = 0;
    GErrorSlot error;
    arv_device_get_integer_feature_bounds(device_, name, &lowest, &highest, error.out());
    value = std::round(value);
    least = error.failed() ? value : static_cast<double>(lowest);
    most = error.failed() ? value : static_cast<double>(highest);
  }
  if (least <= most) value = std::clamp(value, least, most);
  return set_number(name, value);
}

bool Features::execute(const char* name) {
  GErrorSlot error;
  if (device_ == nullptr || node(name) == nullptr) return false;
  arv_device_execute_command(device_, name, error.out());
  return !error.failed();
}

std::size_t Features::restore() {
  std::size_t restored = 0;
  while (!changes_.empty()) {
    const Change change = changes_.back();
    if (!set_for_good(Terminated<47>(change.name.view()).c_str(), change.value.view())) break;
    changes_.pop_back();
    ++restored;
  }
  changes_.clear();
  return restored;
}

}  // namespace roomcal::drivers
