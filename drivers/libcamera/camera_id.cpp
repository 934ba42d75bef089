#include "drivers/libcamera/camera_id.h"

#include <cstddef>

namespace roomcal::drivers {

Result<std::size_t> find_camera_id(std::span<const std::string> ids, std::string_view key) {
  std::size_t found = 0;
  int fits = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == key) return i;
    if (ids[i].find(key) == std::string::npos) continue;
    found = i;
    ++fits;
  }
  if (fits == 1) return found;
  if (fits == 0) return Status{StatusCode::kNotFound, "no camera has this id; see the log for those there"};
  return Status{StatusCode::kNotFound, "several cameras have this in their id; name one by its whole id"};
}

}  // namespace roomcal::drivers
