#include "drivers/v4l2/find_camera.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include "drivers/v4l2/caps.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

constexpr std::size_t kMaxNodes = 64;  // a Raspberry Pi 5 has 35

void tell_place(const VideoNode& node, FixedText<200>& text) {
  text.append(node.name.view());
  text.append(" at ");
  // The end of a path tells places apart; all of two paths would not fit a line.
  constexpr std::size_t kShown = 70;
  const std::string_view path = node.path.view();
  text.append(path.size() > kShown ? path.substr(path.size() - kShown) : path);
}

// Whether an open node is the one; trouble if it cannot be asked.
Trouble ask_node(V4l2Kernel& kernel, const CameraKey& key, std::string_view name, bool& fits) {
  fits = false;
  V4l2Handle handle(kernel);
  ROOMCAL_TRY_CALL(handle.open(name));
  CameraCaps caps;
  ROOMCAL_TRY_CALL(query_caps(handle, caps));
  fits = caps.delivers_images && key.fits_bus(caps.bus_info.view());
  return {};
}

// The search of one key: which nodes fit so far.
struct Search {
  V4l2Kernel& kernel;
  const CameraKey& key;
  FoundCamera& found;
  FixedText<255> link;
  Trouble trouble;
  int fitting = 0;

  void look_at(std::string_view name) {
    VideoNode node;
    if (kernel.describe(name, node) < 0 || !key.fits(node, link.view()))
      return;  // gone since it was listed, or another
    bool fits = false;
    if (const Trouble asked = ask_node(kernel, key, name, fits); !asked.none()) trouble = asked;
    if (fits) take(node);
  }

  void take(const VideoNode& node) {
    if (++fitting == 1) found.node = node;
    if (fitting == 2) {
      tell_place(found.node, found.others);
      found.others.append(" and ");
      tell_place(node, found.others);
    }
  }
};

}  // namespace

Trouble find_camera(V4l2Kernel& kernel, const CameraKey& key, FoundCamera& found) {
  found.others.clear();
  Search search{kernel, key, found, {}, {}};
  if (key.is_link()) {
    const int read = kernel.read_link(key.text(), search.link);
    if (read < 0) return {ImageFault::kNotFound, -read};
  }
  std::array<NodeName, kMaxNodes> names;
  const int listed = kernel.list(names);
  if (listed < 0) return trouble_of(V4l2Call::kFind, -listed);
  for (std::size_t i = 0; i < std::min(static_cast<std::size_t>(listed), names.size()); ++i)
    search.look_at(names[i].view());
  if (search.fitting == 1) return {};
  return search.fitting == 0 && !search.trouble.none() ? search.trouble : Trouble{ImageFault::kNotFound, 0};
}

}  // namespace roomcal::drivers
