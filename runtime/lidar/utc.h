#pragma once

#include <cstdint>

namespace roomcal::lidar {

/// Seconds from 1970-01-01 to a date and time of the proleptic Gregorian calendar, no leap seconds. Fields out of their
/// range carry over, so that any bytes give a number. Source: H. Hinnant, "chrono-compatible low-level date
/// algorithms", days_from_civil.
constexpr int64_t utc_seconds(int64_t year, unsigned month, unsigned day, unsigned hour, unsigned minute,
                              unsigned second) {
  const int64_t y = month <= 2 ? year - 1 : year;
  const int64_t era = (y >= 0 ? y : y - 399) / 400;
  const int64_t year_of_era = y - era * 400;
  const int64_t day_of_year = (153 * (static_cast<int64_t>(month) + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  const int64_t day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  const int64_t days = era * 146097 + day_of_era - 719468;
  return days * 86400 + hour * 3600 + minute * 60 + second;
}
static_assert(utc_seconds(2023, 1, 11, 1, 39, 55) == 1673401195);

}  // namespace roomcal::lidar
