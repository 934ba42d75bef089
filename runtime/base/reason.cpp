#include "runtime/base/reason.h"

#include <cstdarg>
#include <cstdio>

namespace roomcal {

Reason make_reason(const char* format, ...) {
  char text[256];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return Reason(static_cast<const char*>(text));
}

Reason sensor_reason(const SensorName& name, const Status& status) {
  const Name who(name);
  return make_reason("%.*s: %s: %s", who.length, who.text, to_string(status.code()), status.detail());
}

}  // namespace roomcal
