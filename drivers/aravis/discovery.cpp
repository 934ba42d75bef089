#include "drivers/aravis/discovery.h"

#include <algorithm>
#include <array>
#include <mutex>

#include <arv.h>

#include "drivers/gige/gvcp.h"
#include "drivers/gige/ipv4.h"

namespace roomcal::drivers {

namespace {

constexpr gint64 kFreshUs = 1'000'000;

std::string_view text_or_none(const char* text) { return text == nullptr ? "" : text; }

bool answers_to(unsigned int i, std::string_view key) {
  const std::array<const char*, 4> names{arv_get_device_serial_nbr(i), arv_get_device_id(i),
                                         arv_get_device_physical_id(i), arv_get_device_address(i)};
  return std::any_of(names.begin(), names.end(), [&](const char* name) { return text_or_none(name) == key; });
}

struct Matches {
  int count = 0;
  FoundCamera first;
};

Matches matches_of(std::string_view key) {
  Matches matches;
  for (unsigned int i = 0; i < arv_get_n_devices(); ++i)
    if (answers_to(i, key) && ++matches.count == 1)
      matches.first = {text_or_none(arv_get_device_id(i)), text_or_none(arv_get_device_address(i)),
                       text_or_none(arv_get_device_protocol(i)), true};
  return matches;
}

void list(FixedText<200>& seen) {
  seen.clear();
  for (unsigned int i = 0; i < arv_get_n_devices(); ++i) {
    if (i > 0) seen.append(", ");
    seen.append(text_or_none(arv_get_device_serial_nbr(i)));
    seen.append(" (");
    seen.append(text_or_none(arv_get_device_id(i)));
    seen.append(" at ");
    seen.append(text_or_none(arv_get_device_address(i)));
    seen.append(")");
  }
  if (seen.empty()) seen.append("none");
}

}  // namespace

Result<FoundCamera> find_camera(std::string_view key, FixedText<200>& seen) {
  static std::mutex mutex;
  static gint64 looked_us = -kFreshUs;
  const std::lock_guard lock(mutex);
  Matches matches;
  if (g_get_monotonic_time() - looked_us < kFreshUs) matches = matches_of(key);
  if (matches.count != 1) {
    arv_update_device_list();
    looked_us = g_get_monotonic_time();
    matches = matches_of(key);
  }
  list(seen);
  if (matches.count == 0 && ipv4_endpoint(key, gvcp::kPort)) return FoundCamera{key, key, "GigEVision", false};
  if (matches.count == 0) return Status{StatusCode::kNotFound, "no camera has this key; see the log for those there"};
  if (matches.count > 1)
    return Status{StatusCode::kNotFound, "two cameras have this key; use the id, the MAC or the address"};
  return matches.first;
}

}  // namespace roomcal::drivers
